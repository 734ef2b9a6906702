// What the page of a calibration does beyond being read: values under the pointer, zoom, keys, sorted tables, downloads, links
// into folds. Everything is drawn without it; it reads the numbers that stand in the page and asks for nothing from outside.
(function () {
'use strict';

const ALPHABET = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';
const CODES = {};
for (let i = 0; i < 64; ++i) CODES[ALPHABET[i]] = i;
const UNDEFINED = 262143, LARGEST = 262142;

// [lowest, highest, three characters a value] as page_figure.cpp packs it; null: undefined. Rounded to what three characters hold.
function unpack([lowest, highest, text], logarithmic) {
  const step = (highest - lowest) / LARGEST;
  const decimals = step > 0 ? Math.min(20, Math.max(0, Math.ceil(-Math.log10(step)))) : 20;
  const values = [];
  for (let i = 0; i < text.length; i += 3) {
    const code = CODES[text[i]] << 12 | CODES[text[i + 1]] << 6 | CODES[text[i + 2]];
    const value = lowest + step * code;
    values.push(code === UNDEFINED ? null
      : logarithmic ? +Math.exp(value).toPrecision(5)
      : step > 0 ? +value.toFixed(decimals) : lowest);
  }
  return values;
}

// A number as a reader wants it: five digits, a true minus.
const say = value => String(+value.toPrecision(5)).replace('-', '\u2212');

const fraction = (axis, v) => axis.log ? Math.log(v / axis.from) / Math.log(axis.to / axis.from)
                                       : (v - axis.from) / (axis.to - axis.from);
const value_at = (axis, f) => axis.log ? axis.from * Math.pow(axis.to / axis.from, f)
                                       : axis.from + f * (axis.to - axis.from);

// Round values within the axis, [value, label, exponent of ten where the label is one], as axis.cpp makes them.
function ticks(axis, wanted) {
  const list = [];
  const decades = axis.log ? Math.log10(axis.to / axis.from) : 0;
  if (decades >= 1.5) {
    const first = Math.ceil(Math.log10(axis.from) - 1e-9), last = Math.floor(Math.log10(axis.to) + 1e-9);
    const stride = Math.max(1, Math.ceil((last - first) / wanted));
    for (let k = first; k <= last; ++k) {
      const labelled = (k - first) % stride === 0;
      list.push([Math.pow(10, k), labelled ? '10' : '', labelled ? String(k).replace('-', '\u2212') : '']);
    }
    return list;
  }
  const raw = (axis.to - axis.from) / wanted, decade = Math.pow(10, Math.floor(Math.log10(raw))), m = raw / decade;
  const step = (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10) * decade;
  const decimals = Math.min(20, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  for (let k = Math.ceil(axis.from / step - 1e-9); k * step <= axis.to + 1e-9 * step; ++k) {
    const v = k * step;
    list.push([v, decimals > 5 || Math.abs(v) >= 1e6 ? say(v) : v.toFixed(decimals).replace(/^-(?=.*[1-9])|^-/, s => v < -step / 2 ? '\u2212' : ''), '']);
  }
  return list;
}

// The numbers of a figure, one point a line.
function csv(figure) {
  const quote = text => /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
  const lines = ['panel,series,abscissa,ordinate,x,y,standard error,half width of 95 % band,of a second band'];
  for (const panel of figure.panels) {
    for (const s of panel.series) {
      s.x.forEach((x, i) => lines.push([quote(panel.title), quote(s.label), quote(panel.x.label), quote(panel.y.label), x, s.y[i],
        ...[s.error, s.bands[0], s.bands[1]].map(list => list ? list[i] : '')].join(',')));
    }
  }
  return lines.join('\n') + '\n';
}

// Order of two cells: numbers ascending, then words; what is empty comes last either way.
function compare(a, b, descending) {
  if (a === '' || b === '') return (a === '') - (b === '');
  const numbers = [typeof a, typeof b].filter(t => t === 'number').length;
  const order = numbers === 2 ? a - b : numbers === 1 ? (typeof a === 'number' ? -1 : 1) : a.localeCompare(b);
  return descending ? -order : order;
}

// A figure's data with its numbers unpacked.
function read_figure(data) {
  const unpacked = {};
  const numbers = (index, log) => index === undefined ? undefined
    : unpacked[index + (log ? 'l' : '')] ||= unpack(data.arrays[index], log);
  const axis = ([label, from, to, log]) => ({label, from, to, log, all: [from, to]});
  for (const panel of data.panels) {
    panel.x = axis(panel.x);
    panel.y = axis(panel.y);
    for (const s of panel.series) {
      s.x = numbers(s.x, panel.x.log);
      s.y = numbers(s.y, panel.y.log);
      s.error = numbers(s.error);
      s.bands = (s.bands || []).map(b => numbers(b));
    }
  }
  return data;
}

if (typeof module === 'object') module.exports = {unpack, say, ticks, csv, compare, read_figure, fraction, value_at};
if (typeof document === 'undefined') return;

// --- figures ------------------------------------------------------------------------------------------------------------

const make = (tag, attributes, parent) => {
  const element = document.createElementNS(tag === 'circle' || tag === 'rect' ? 'http://www.w3.org/2000/svg' : 'http://www.w3.org/1999/xhtml', tag);
  for (const key in attributes) key === 'text' ? element.textContent = attributes[key] : element.setAttribute(key, attributes[key]);
  if (parent) parent.append(element);
  return element;
};
const px = (p, v) => p.left + p.width * Math.min(4, Math.max(-3, fraction(p.x, v)));
const py = (p, v) => p.top + p.height * (1 - Math.min(4, Math.max(-3, fraction(p.y, v))));
const defined = (axis, v) => v !== null && v !== undefined && isFinite(v) && (!axis.log || v > 0);
const inside = (axis, v) => { const f = fraction(axis, v); return f > -1e-6 && f < 1 + 1e-6; };
const at = (x, y) => x.toFixed(1) + ' ' + y.toFixed(1);

// Grid, ticks and numbers anew, then each path of each series, in the order that svg_series.cpp writes them.
function redraw(p) {
  let grid = '', marks = '', words = '';
  const bottom = p.top + p.height, right = p.left + p.width;
  const number = (x, y, anchor, [, label, exponent]) => words += '<text x="' + x + '" y="' + y + '" text-anchor="' + anchor + '">' +
    label + (exponent ? '<tspan dy="-5" font-size="75%">' + exponent + '</tspan>' : '') + '</text>';
  for (const tick of ticks(p.x, Math.max(3, Math.floor(p.width / 60)))) {
    const x = px(p, tick[0]).toFixed(1);
    grid += 'M' + x + ' ' + p.top + 'V' + bottom;
    marks += 'M' + x + ' ' + bottom + 'v5';
    number(x, bottom + 18, 'middle', tick);
  }
  for (const tick of ticks(p.y, 5)) {
    const y = py(p, tick[0]);
    grid += 'M' + p.left + ' ' + y.toFixed(1) + 'H' + right;
    marks += 'M' + p.left + ' ' + y.toFixed(1) + 'h-5';
    number(p.left - 8, (y + 4).toFixed(1), 'end', tick);
  }
  if (p.zero && p.y.from < 0 && p.y.to > 0) marks += 'M' + at(p.left, py(p, 0)) + 'H' + right;
  p.scale.innerHTML = '<path class="grid" d="' + grid + '"/><path class="axis" d="' + marks + '"/>' + words;
  for (const s of p.series) {
    const n = s.x.length, shown = i => defined(p.x, s.x[i]) && defined(p.y, s.y[i]);
    const set = (path, d) => path && path.setAttribute('d', d || 'M0 0');
    s.paths.b.forEach((path, k) => {
      let d = '', low = [], high = [];
      for (let i = 0; i <= n; ++i) {
        const w = i < n && shown(i) ? s.bands[k][i] : null;
        if (w !== null && defined(p.y, s.y[i] - w)) {
          low.push(at(px(p, s.x[i]), py(p, s.y[i] - w)));
          high.unshift(at(px(p, s.x[i]), py(p, s.y[i] + w)));
        } else {
          if (low.length > 1) d += 'M' + low.concat(high).join('L') + 'z';
          low = [], high = [];
        }
      }
      set(path, d);
    });
    let line = '', marker = '', bars = '', pen = 'M';
    for (let i = 0; i < n; ++i) {
      if (!shown(i)) { pen = 'M'; continue; }
      const x = px(p, s.x[i]), y = py(p, s.y[i]);
      line += pen + at(x, y);
      pen = 'L';
      if (inside(p.x, s.x[i]) && inside(p.y, s.y[i])) marker += (marker ? 'L' : 'M') + at(x, y);
      const e = s.error && s.error[i];
      if (e > 0 && defined(p.y, s.y[i] - e)) {
        for (const end of [py(p, s.y[i] - e), py(p, s.y[i] + e)]) bars += 'M' + at(x - 2.5, end) + 'h5M' + at(x, y) + 'L' + at(x, end);
      }
    }
    set(s.paths.l[0], line);
    set(s.paths.e[0], bars);
    set(s.paths.m[0], marker && !marker.includes('L') ? marker + 'h0' : marker);
  }
}

// Shows the part `fs` of x and `gs` of y, fractions of what is shown: of panel `p` and of all that have the same axis, or without
// `p` of every panel. Never more than the whole.
function zoom(figure, p, fs, gs) {
  const changes = [];
  for (const q of figure.panels) {
    for (const [axis, like, part] of [[q.x, (p || q).x, fs], [q.y, (p || q).y, gs]]) {
      if (axis.label === like.label && axis.from === like.from && axis.to === like.to)
        changes.push([axis, Math.max(axis.all[0], value_at(axis, part[0])), Math.min(axis.all[1], value_at(axis, part[1]))]);
    }
  }
  for (const [axis, from, to] of changes) {
    const whole = {...axis, from: axis.all[0], to: axis.all[1]};
    if (fraction(whole, to) - fraction(whole, from) > 1e-4) axis.from = from, axis.to = to;
  }
  figure.panels.forEach(redraw);
  unmark(figure);
}
const whole = figure => zoom(figure, undefined, [-1e9, 1e9], [-1e9, 1e9]);

const visible = s => !s.box || s.box.checked;
const can_show = (p, s, i) => defined(p.x, s.x[i]) && defined(p.y, s.y[i]) && inside(p.x, s.x[i]) && inside(p.y, s.y[i]);

// The point nearest to a place [px]: {s, i}, undefined where none is within `reach`.
function nearest(p, x, y, reach) {
  let best, least = reach * reach;
  for (const s of p.series) {
    if (!visible(s)) continue;
    for (let i = 0; i < s.x.length; ++i) {
      if (!can_show(p, s, i)) continue;
      const d = (px(p, s.x[i]) - x) ** 2 + (py(p, s.y[i]) - y) ** 2;
      if (d < least) least = d, best = {s, i};
    }
  }
  return best;
}

function words_of(p, {s, i}) {
  const unit = label => (label.match(/\[(.*)\]/) || ['', ''])[1].replace('\u2013', '');
  const name = label => label.replace(/ *\[.*\]/, '');
  let text = (s.label ? s.label + ': ' : '') + name(p.x.label) + ' ' + say(s.x[i]) + ' ' + unit(p.x.label) + ', ' +
    name(p.y.label) + ' ' + say(s.y[i]);
  if (s.error && s.error[i] > 0) text += ' \u00b1 ' + say(s.error[i]);
  if (s.bands[0] && s.bands[0][i] !== null) text += ', band \u00b1 ' + say(s.bands[0][i]);
  return (text + ' ' + unit(p.y.label)).replace(/ +(?=,|$)/g, '');
}

let tip;
function unmark(figure) {
  if (tip) tip.hidden = true;
  figure.panels.forEach(p => p.ring.setAttribute('r', 0));
}
function mark(figure, p, point) {
  unmark(figure);
  p.ring.setAttribute('r', 7);
  p.ring.setAttribute('cx', px(p, point.s.x[point.i]));
  p.ring.setAttribute('cy', py(p, point.s.y[point.i]));
  tip ||= make('div', {class: 'tip', 'aria-hidden': 'true'}, document.body);
  tip.textContent = words_of(p, point);
  tip.hidden = false;
  const ring = p.ring.getBoundingClientRect(), room = document.documentElement.clientWidth - tip.offsetWidth - 4;
  tip.style.left = Math.max(4, Math.min(room, ring.left + 14)) + scrollX + 'px';
  tip.style.top = ring.top + scrollY - tip.offsetHeight - 4 + 'px';
}

// Arrows go along a series and from one to the next, + and - zoom about the point, Escape shows the whole range.
function press(figure, p, event) {
  const list = p.series.filter(s => visible(s) && s.x.some((_, i) => can_show(p, s, i)));
  if (event.key === 'Escape' || event.key === '0') whole(figure);
  else if ((event.key === '+' || event.key === '=' || event.key === '-') && !event.ctrlKey) {
    const f = p.point ? fraction(p.x, p.point.s.x[p.point.i]) : .5, g = p.point ? fraction(p.y, p.point.s.y[p.point.i]) : .5;
    const h = event.key === '-' ? 1 : .25;
    zoom(figure, p, [f - h, f + h], [g - h, g + h]);
    figure.readout.textContent = 'Shown: ' + say(p.x.from) + ' to ' + say(p.x.to) + ' and ' + say(p.y.from) + ' to ' + say(p.y.to);
  } else if (/^(Arrow|Home|End)/.test(event.key) && list.length) {
    let {s, i} = p.point && list.includes(p.point.s) ? p.point : {s: list[0], i: -1};
    const step = event.shiftKey ? 10 : 1;
    const go = (from, by) => {
      for (let k = from; k >= 0 && k < s.x.length; k += by) if (can_show(p, s, k)) return k;
      return i >= 0 && can_show(p, s, i) ? i : s.x.findIndex((_, k) => can_show(p, s, k));
    };
    if (event.key === 'ArrowRight') i = go(i + step, 1);
    else if (event.key === 'ArrowLeft') i = go(i - step, -1);
    else if (event.key === 'Home') i = go(0, 1);
    else if (event.key === 'End') i = go(s.x.length - 1, -1);
    else {
      const x = s.x[i], next = list.indexOf(s) + (event.key === 'ArrowUp' ? -1 : 1);
      s = list[(next + list.length) % list.length];
      i = s.x.reduce((best, v, k) => can_show(p, s, k) && (best < 0 || Math.abs(v - x) < Math.abs(s.x[best] - x)) ? k : best, -1);
    }
    p.point = {s, i};
    mark(figure, p, p.point);
    figure.readout.textContent = words_of(p, p.point);
  } else return;
  event.preventDefault();
}

function watch(figure, p) {
  let from, box;
  const place = event => {
    const r = p.svg.getBoundingClientRect(), view = p.svg.viewBox.baseVal;
    return [(event.clientX - r.left) * view.width / r.width, (event.clientY - r.top) * view.height / r.height];
  };
  const end = () => { if (box) box.remove(); from = box = undefined; };
  p.svg.addEventListener('pointerdown', event => {
    if (event.button === 0 && event.pointerType === 'mouse') from = place(event), event.preventDefault(), p.svg.focus({preventScroll: true});
  });
  p.svg.addEventListener('pointermove', event => {
    const [x, y] = place(event);
    if (from && Math.hypot(x - from[0], y - from[1]) > 5) {
      box ||= make('rect', {class: 'box'}, p.svg);
      const sides = {x: Math.min(x, from[0]), y: Math.min(y, from[1]), width: Math.abs(x - from[0]), height: Math.abs(y - from[1])};
      for (const key in sides) box.setAttribute(key, sides[key]);
      return unmark(figure);
    }
    const point = nearest(p, x, y, 30);
    point ? mark(figure, p, p.point = point) : unmark(figure);
  });
  p.svg.addEventListener('pointerup', event => {
    if (from && box) {
      const clamp = f => Math.min(1, Math.max(0, f));
      const [x, y] = place(event);
      const f = [from[0], x].map(v => clamp((v - p.left) / p.width)).sort((a, b) => a - b);
      const g = [from[1], y].map(v => clamp(1 - (v - p.top) / p.height)).sort((a, b) => a - b);
      if (f[1] - f[0] > .01 && g[1] - g[0] > .01) zoom(figure, p, f, g);
    }
    end();
  });
  p.svg.addEventListener('pointerleave', () => { end(); unmark(figure); });
  p.svg.addEventListener('dblclick', () => whole(figure));
  p.svg.addEventListener('keydown', event => press(figure, p, event));
  p.svg.addEventListener('blur', () => unmark(figure));
}

const save = (name, type, text) => {
  const link = make('a', {download: name, href: URL.createObjectURL(new Blob([text], {type}))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1e4);
};

// The figure as one file, as it is shown now: legend above, panels in their columns.
function svg_of(figure) {
  const {width, height} = figure.panels[0].svg.viewBox.baseVal, total = width * figure.columns;
  let x = 10, y = 14, legend = '';
  for (const entry of figure.element.querySelectorAll('.legend > :not(.toggles)')) {
    const box = entry.querySelector('input'), key = entry.querySelector('svg > g');
    if (box && !box.checked || !entry.getClientRects().length || !key) continue;
    const taken = 52 + 6.6 * entry.textContent.trim().length;
    if (x > 10 && x + taken > total) x = 10, y += 20;
    const text = make('rect', {});
    text.append(entry.textContent.trim());
    legend += '<g transform="translate(' + x + ' ' + (y - 12) + ')">' + key.outerHTML + '</g><text x="' + (x + 30) + '" y="' + y + '">' +
      text.innerHTML + '</text>';
    x += taken;
  }
  const top = legend ? y + 10 : 0;
  const panels = figure.panels.map((p, i) => {
    const copy = p.svg.cloneNode(true);
    copy.querySelectorAll('.ring').forEach(e => e.remove());
    p.series.forEach((s, k) => visible(s) || copy.querySelectorAll('g.s')[k].classList.add('away'));
    copy.querySelectorAll('.away').forEach(e => e.remove());
    for (const a of ['tabindex', 'role', 'aria-roledescription']) copy.removeAttribute(a);
    const sides = {x: i % figure.columns * width, y: top + Math.floor(i / figure.columns) * height, width, height};
    for (const key in sides) copy.setAttribute(key, sides[key]);
    return new XMLSerializer().serializeToString(copy);
  });
  return '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ' + total + ' ' + (top + height * Math.ceil(panels.length / figure.columns)) +
    '"><style>' + document.querySelector('style').textContent.replace(/[<&]/g, '') + 'svg{background:var(--ground)}</style><title>' + figure.title.replace(/[<&]/g, '') + '</title>' + legend + panels.join('') + '</svg>\n';
}

function start_figure(element) {
  const data = element.querySelector('script');
  if (!data) return;
  const svgs = element.querySelectorAll('svg.p');
  if (!svgs.length) return;
  let figure;
  // Numbers are unpacked when a figure is first touched.
  const awake = () => {
    if (figure) return figure;
    figure = read_figure(JSON.parse(data.textContent));
    figure.element = element;
    figure.readout = readout;
    figure.panels.forEach((p, i) => {
      p.svg = svgs[i];
      p.scale = p.svg.querySelector('g.a');
      const frame = p.svg.querySelector('rect.axis');
      for (const key of ['x', 'y', 'width', 'height']) p[{x: 'left', y: 'top'}[key] || key] = +frame.getAttribute(key);
      p.svg.querySelectorAll('g.s').forEach((g, k) => {
        const s = p.series[k];
        s.paths = {b: [...g.querySelectorAll('.b')]};
        for (const c of 'elm') s.paths[c] = [...g.querySelectorAll('.' + c)];
        s.box = s.toggle === undefined ? null : element.querySelector('.c' + s.toggle);
        g.querySelector('title')?.remove();
      });
      p.ring = make('circle', {class: 'ring', r: 0}, p.svg);
      watch(figure, p);
    });
    return figure;
  };
  const tools = make('div', {class: 'tools'});
  const readout = make('output', {class: 'readout', 'aria-live': 'polite'});
  element.querySelector('figcaption').before(tools);
  const button = (text, label, act) => make('button', {type: 'button', text, 'aria-label': label + ' of ' + element.id}, tools)
    .addEventListener('click', () => act(awake()));
  button('+', 'Zoom into the middle', f => zoom(f, undefined, [.25, .75], [.25, .75]));
  button('\u2212', 'Zoom out', f => zoom(f, undefined, [-.5, 1.5], [-.5, 1.5]));
  button('Whole range', 'Whole range', whole);
  button('CSV', 'Numbers', f => save(element.id + '.csv', 'text/csv', csv(f)));
  button('SVG', 'Drawing', f => save(element.id + '.svg', 'image/svg+xml', svg_of(f)));
  tools.append(readout);
  svgs.forEach(svg => {
    svg.setAttribute('tabindex', '0');
    svg.setAttribute('role', 'application');
    svg.setAttribute('aria-roledescription', 'figure with points; arrow keys read them, plus and minus zoom, Escape shows all');
    for (const type of ['pointerenter', 'focus']) svg.addEventListener(type, awake, {once: true});
  });
}

// --- tables -------------------------------------------------------------------------------------------------------------

function start_table(table) {
  const body = table.tBodies[0], heads = [...table.tHead.rows[0].cells];
  if (body.rows.length < 3) return;
  const key = (row, column) => {
    const cell = row.cells[column];
    return cell.dataset.value !== undefined ? +cell.dataset.value : cell.textContent.trim();
  };
  heads.forEach((head, column) => {
    const button = make('button', {type: 'button', class: 'sort'});
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener('click', () => {
      const descending = head.getAttribute('aria-sort') === 'ascending';
      heads.forEach(h => h.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', descending ? 'descending' : 'ascending');
      const groups = [];  // a row and the note beneath it
      for (const row of body.rows) row.className === 'note' ? groups[groups.length - 1].push(row) : groups.push([row]);
      groups.sort((a, b) => compare(key(a[0], column), key(b[0], column), descending));
      body.append(...groups.flat());
    });
  });
}

// --- links --------------------------------------------------------------------------------------------------------------

function unfold() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  let opened = false;
  for (let e = target; e; e = e.parentElement) if (e.tagName === 'DETAILS' && !e.open) opened = e.open = true;
  if (opened) target.scrollIntoView();
}

document.querySelectorAll('figure').forEach(start_figure);
document.querySelectorAll('table').forEach(start_table);
addEventListener('hashchange', unfold);
unfold();
})();
