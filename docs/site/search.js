// Search of these pages, from disk: the index is a script, which pages may load where they may not fetch files. It is loaded
// when somebody searches. All words must be in a section, or in its page's title.
'use strict';
const up = document.currentScript.dataset.up;
const form = document.querySelector('form[role=search]');
const found = document.getElementById('found');
const article = document.querySelector('article');
let searchIndex = null;

function element(name, text, attributes = {}) {
  const made = Object.assign(document.createElement(name), attributes);
  made.textContent = text;
  return made;
}

function count(text, word) {
  return text.toLowerCase().split(word).length - 1;
}

function score(section, words) {
  let sum = 0;
  for (const word of words) {
    const hits = 20 * count(section.title, word) + 5 * count(section.page, word) + Math.min(5, count(section.text, word));
    if (hits === 0) return 0;
    sum += hits;
  }
  return section.url.includes('-log.html') ? sum / 10 : sum;  // the whole records come last
}

function excerpt(text, words) {
  const places = words.map((word) => text.toLowerCase().indexOf(word)).filter((place) => place >= 0);
  const begin = Math.max(0, Math.min(...places, text.length) - 60);
  return (begin > 0 ? '… ' : '') + text.slice(begin, begin + 200) + (begin + 200 < text.length ? ' …' : '');
}

function show() {
  const query = form.q.value.trim();
  const words = query.toLowerCase().split(/\s+/).filter((word) => word);
  found.hidden = words.length === 0;
  article.hidden = !found.hidden;
  if (found.hidden) return;
  const best = searchIndex.map((section) => ({section, score: score(section, words)}))
    .filter((hit) => hit.score > 0).sort((a, b) => b.score - a.score);
  found.replaceChildren(element('h1', `${best.length} sections with “${query}”`));
  for (const {section} of best.slice(0, 20)) {
    const title = section.title === section.page ? section.page : `${section.page}: ${section.title}`;
    const link = element('a', title, {href: up + section.url});
    link.addEventListener('click', () => { form.q.value = ''; show(); });  // also where the page is this one
    found.append(link, element('p', excerpt(section.text, words)));
  }
}

function search() {
  if (searchIndex) return show();
  const script = element('script', '', {src: up + 'search-index.js'});
  script.addEventListener('load', show);
  document.head.append(script);
}

form.hidden = false;
form.addEventListener('input', search);
form.addEventListener('submit', (event) => { event.preventDefault(); search(); });
const asked = new URLSearchParams(location.search).get('q');
if (asked) {
  form.q.value = asked;
  search();
}
if (matchMedia('(max-width: 60rem)').matches) document.querySelector('nav details').open = false;
