// The page GRAINLAW_PAGE in headless Chromium, with npm's packages in GRAINLAW_PAGE_MODULES: see run.sh. Into GRAINLAW_PAGE_OUT, where
// given, go screenshots at three widths and the print.
import assert from 'node:assert/strict';
import {mkdirSync, readFileSync, existsSync} from 'node:fs';
import {createRequire} from 'node:module';
import {resolve} from 'node:path';
import test, {after, before} from 'node:test';

const require = createRequire(process.env.GRAINLAW_PAGE_MODULES + '/');
const puppeteer = require('puppeteer-core');
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const url = 'file://' + resolve(process.env.GRAINLAW_PAGE);
const out = process.env.GRAINLAW_PAGE_OUT;

let browser;
before(async () => {
  const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
  browser = await puppeteer.launch({executablePath, args: ['--no-sandbox', '--headless=new']});
  if (out) mkdirSync(out, {recursive: true});
});
after(() => browser?.close());

// Opens the page in its own tab; complaints: what the console, uncaught errors and requests say.
async function open({width = 1280, height = 800, script = true, hash = '', dark = false, setup} = {}) {
  const tab = await browser.newPage();
  const complaints = [];
  tab.on('console', message => complaints.push(message.text()));
  tab.on('pageerror', error => complaints.push(String(error)));
  tab.on('request', request => { if (!request.url().startsWith(url)) complaints.push('request ' + request.url().slice(0, 80)); });
  await tab.setJavaScriptEnabled(script);
  await tab.setViewport({width, height});
  if (dark) await tab.emulateMediaFeatures([{name: 'prefers-color-scheme', value: 'dark'}]);
  if (setup) await tab.evaluateOnNewDocument(setup);
  await tab.goto(url + hash);
  return {tab, complaints};
}

// Of every panel: its paths and what one sees of them. Runs in the tab, with or without the page's own script.
const drawing = tab => tab.$$eval('figure svg.p', svgs => svgs.map(svg => ({
  figure: svg.closest('figure').id,
  paths: [...svg.querySelectorAll('path')].map(p => p.getAttribute('d')),
  inked: [...svg.querySelectorAll('g.s path')].filter(p => { const b = p.getBBox(); return b.width + b.height > 0; }).length,
  series: svg.querySelectorAll('g.s').length,
  numbers: [...svg.querySelectorAll('g.a text')].map(t => t.textContent)})));

test('nothing is requested and nothing complains', async () => {
  const {tab, complaints} = await open();
  await tab.evaluate(() => document.querySelectorAll('details').forEach(d => d.open = true));
  for (const button of await tab.$$('button')) await button.evaluate(b => { if (!/CSV|SVG/.test(b.textContent)) b.click(); });
  assert.deepEqual(complaints, []);
});

test('every figure is drawn, the same without the script', async () => {
  const with_script = await drawing((await open()).tab), without = await drawing((await open({script: false})).tab);
  assert.ok(with_script.length >= 10, String(with_script.length));
  assert.deepEqual(with_script, without);
  for (const panel of without) {
    if (panel.figure === 'packing') {  // pictures without axes
      assert.ok(panel.paths.join('').length > 100, 'a picture of the packing shows nothing');
    } else {
      assert.ok(panel.inked > 0 || panel.series === 0, panel.figure + ' shows nothing');
      assert.ok(panel.numbers.length >= 4, panel.figure + ': ' + panel.numbers);
    }
    for (const d of panel.paths) assert.doesNotMatch(d, /nan|inf|undefined/i, panel.figure);
  }
});

test('toggles hide and show, also without the script', async () => {
  for (const script of [true, false]) {
    const {tab} = await open({script});
    const boxes = await tab.$$('figure .legend input');
    assert.ok(boxes.length >= 4, String(boxes.length));
    for (const box of boxes) {
      const state = () => box.evaluate(b => {
        const shown = [...b.closest('figure').querySelectorAll('g.s.t' + b.className.slice(1))].map(g => getComputedStyle(g).display !== 'none');
        return [b.checked, shown.length, shown.every(Boolean), shown.some(Boolean)];
      });
      const first = await state();
      assert.ok(first[1] > 0);
      assert.deepEqual(first.slice(2), [first[0], first[0]]);
      await box.evaluate(b => b.click());
      const second = await state();
      assert.deepEqual(second, [!first[0], first[1], !first[0], !first[0]]);
    }
  }
});

// The corners of a panel's frame on the screen.
const frame_of = panel => panel.evaluate(svg => { svg.scrollIntoView({block: 'center'}); const r = svg.querySelector('rect.axis').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; });
const extents = figure => figure.$$eval('g.s path', paths => paths.map(p => { const b = p.getBBox(); return p.getAttribute('d') ? [b.x, b.y, b.width, b.height] : null; }));
const numbers_of = panel => panel.$$eval('g.a text', texts => texts.map(t => t.textContent));

async function drag(tab, [left, top, width, height], from, to) {
  await tab.mouse.move(left + from[0] * width, top + from[1] * height);
  await tab.mouse.down();
  await tab.mouse.move(left + to[0] * width, top + to[1] * height, {steps: 4});
  await tab.mouse.up();
}

test('dragging zooms with new ticks, Escape shows the whole as it was drawn', async () => {
  const {tab} = await open();
  await tab.evaluate(() => document.querySelectorAll('details').forEach(d => d.open = true));
  for (const figure of await tab.$$('figure:has(svg.p)')) {
    const id = await figure.evaluate(f => f.id), panel = await figure.$('svg.p');
    if (!await panel.$('g.s')) continue;
    const whole = await numbers_of(panel), drawn = await extents(figure);
    await drag(tab, await frame_of(panel), [.3, .3], [.55, .6]);
    const part = await numbers_of(panel);
    assert.notDeepEqual(part, whole, id + ': same ticks');
    assert.ok(part.length >= 4, id + ': ' + part);
    await panel.evaluate(p => p.focus());
    await tab.keyboard.press('Escape');
    const numbers = list => list.filter(t => t !== '').map(t => parseFloat(t.replace('\u2212', '-')));
    const again = await numbers_of(panel);
    assert.ok(again.length >= 4, id);
    for (const n of numbers(whole)) assert.ok(numbers(again).includes(n), id + ': ' + whole + ' became ' + again);
    // Drawn anew from the packed numbers every path is where the program drew it, but for a part of a pixel.
    (await extents(figure)).forEach((box, i) => drawn[i]?.forEach((v, k) =>
      assert.ok(Math.abs(v - box[k]) < .8, id + ' path ' + i + ': ' + drawn[i] + ' became ' + box)));
  }
});

test('panels with the same axis zoom together', async () => {
  const {tab} = await open();
  const figure = await tab.$('#fabric'), panels = await figure.$$('svg.p');
  const before = await numbers_of(panels[1]);
  await drag(tab, await frame_of(panels[0]), [.1, .1], [.4, .4]);
  assert.deepEqual(await numbers_of(panels[0]), await numbers_of(panels[1]));
  assert.notDeepEqual(await numbers_of(panels[1]), before);
});

test('the value under the pointer is said, and is that of the point', async () => {
  const {tab} = await open();
  for (const id of ['prediction-1', 'shear-laws']) {
    const panel = await tab.$('#' + id + ' svg.p');
    await frame_of(panel);
    const point = await panel.evaluate(svg => {
      const path = [...svg.querySelectorAll('g.s path.m')].find(p => p.getTotalLength() > 0);
      const q = path.getPointAtLength(0), m = path.getScreenCTM();
      return [q.x * m.a + m.e, q.y * m.d + m.f];
    });
    await tab.mouse.move(point[0] - 40, point[1]);
    await tab.mouse.move(point[0], point[1]);
    const tip = await tab.$eval('.tip', t => [t.hidden, t.textContent]);
    assert.equal(tip[0], false);
    const ring = await panel.$eval('.ring', r => { const b = r.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; });
    assert.ok(Math.hypot(ring[0] - point[0], ring[1] - point[1]) < 1.5, ring + ' ' + point);
    assert.match(tip[1], /-?\d/);
    // The number of x, against the ticks: it lies where they say.
    const said = parseFloat(tip[1].replace(/^.*?: /, '').replace(/\u2212/g, '-').match(/ (-?[\d.]+(?:e-?\d+)?)/)[1]);
    const expected = await panel.evaluate((svg, x) => {
      const ticks = [...svg.querySelectorAll('g.a text[text-anchor=middle]')].map(t => [t.getBoundingClientRect(), parseFloat(t.textContent.replace('\u2212', '-'))])
        .map(([r, v]) => [r.left + r.width / 2, v]);
      const [a, b] = [ticks[0], ticks[ticks.length - 1]];
      return [a[1] + (x - a[0]) * (b[1] - a[1]) / (b[0] - a[0]), Math.abs(b[1] - a[1])];
    }, ring[0]);
    assert.ok(Math.abs(said - expected[0]) < .02 * expected[1], tip[1] + ' is at ' + expected[0]);
  }
});

test('a keyboard reads points, changes series, zooms and goes back', async () => {
  const {tab} = await open();
  const panel = await tab.$('#stress-ratio svg.p');
  await panel.evaluate(p => p.focus());
  const readout = () => tab.$eval('#stress-ratio .readout', r => r.textContent);
  assert.equal(await tab.$eval('#stress-ratio .readout', r => r.getAttribute('aria-live')), 'polite');
  assert.equal(await readout(), '');
  const said = [];
  for (const key of ['ArrowRight', 'ArrowRight', 'End', 'Home', 'ArrowDown']) {
    await tab.keyboard.press(key);
    said.push(await readout());
  }
  assert.equal(new Set(said.slice(0, 3)).size, 3, said.join('\n'));
  assert.equal(said[3], said[0]);
  assert.notEqual(said[4].split(':')[0] + said[4], said[3].split(':')[0] + said[3]);
  const whole = await numbers_of(panel);
  await tab.keyboard.press('+');
  assert.notDeepEqual(await numbers_of(panel), whole);
  assert.match(await readout(), /^Shown: .* to .*, .* to /);
  await tab.keyboard.press('Escape');
  const again = await numbers_of(panel);
  assert.deepEqual(again.map(parseFloat), whole.map(parseFloat));
  // Tab leads out of a panel to the next, and to the buttons.
  await tab.keyboard.press('Tab');
  assert.notEqual(await tab.evaluate(() => document.activeElement.getAttribute('aria-label')), await panel.evaluate(p => p.getAttribute('aria-label')));
});

test('tables sort by their numbers, and notes stay with their rows', async () => {
  const {tab} = await open();
  await tab.evaluate(() => document.querySelectorAll('details').forEach(d => d.open = true));
  const tables = await tab.$$eval('table', all => all.map(table => {
    const rows = () => [...table.tBodies[0].rows].filter(r => r.className !== 'note').map(r => [...r.cells].map(c => c.dataset.value ?? c.textContent.trim()));
    const notes = () => [...table.querySelectorAll('tr.note')].map(n => n.previousElementSibling.textContent + '|' + n.textContent).sort();
    const said = {caption: table.caption.textContent, before: rows(), notes_before: notes(), columns: []};
    for (const button of table.querySelectorAll('th button')) {
      button.click();
      const column = button.parentElement.cellIndex;
      said.columns.push([rows().map(r => r[column]), [...table.querySelectorAll('[aria-sort]')].map(h => [h.cellIndex === column, h.ariaSort])]);
    }
    return {...said, after: rows(), notes_after: notes()};
  }));
  let sorted = 0;
  for (const {caption, before, notes_before, columns, after, notes_after} of tables) {
    for (const [cells, marks] of columns) {
      const values = cells.filter(v => v !== '' && !isNaN(v)).map(Number);
      assert.deepEqual(values, [...values].sort((a, b) => a - b), caption);
      assert.deepEqual(marks, [[true, 'ascending']], caption);
      sorted += values.length > 2;
    }
    assert.deepEqual(after.map(String).sort(), before.map(String).sort(), caption);
    assert.deepEqual(notes_after, notes_before, caption);
  }
  assert.ok(sorted > 20, String(sorted));
});

test('a link into a fold opens it', async () => {
  const {tab} = await open();
  const ids = await tab.$$eval('details [id]', es => es.filter(e => e.closest('details') && !e.closest('svg')).map(e => e.id));
  for (const id of ids.slice(0, 4)) {
    const {tab: linked} = await open({hash: '#' + id});
    assert.ok(await linked.$eval('#' + id, e => e.closest('details').open && e.getClientRects().length > 0), id);
  }
  const links = await tab.$$eval('a[href^="#"]', as => as.map(a => a.getAttribute('href').slice(1)).filter(h => !document.getElementById(h)));
  assert.deepEqual(links, [], 'links that lead nowhere');
});

test('numbers and drawings of each figure can be saved', async () => {
  const {tab, complaints} = await open({setup: () => {
    window.saved = [];
    const make = URL.createObjectURL;
    URL.createObjectURL = blob => { blob.text().then(text => window.saved.push([blob.type, text])); return make.call(URL, blob); };
    HTMLAnchorElement.prototype.click = function () { window.names = (window.names || []).concat(this.download); };
  }});
  const figures = await tab.$$('figure:has(svg.p)');
  for (const figure of figures) {
    for (const button of await figure.$$('.tools button')) await button.evaluate(b => { if (/CSV|SVG/.test(b.textContent)) b.click(); });
  }
  const with_numbers = (await tab.$$('figure:has(svg.p):has(script)')).length;
  assert.ok(with_numbers >= figures.length - 1, 'all but the packing have numbers');
  await tab.waitForFunction(n => window.saved.length === n, {}, figures.length + with_numbers);
  const checked = await tab.evaluate(() => window.saved.map(([type, text]) => {
    if (type === 'text/csv') return ['csv', text.split('\n').length, /^panel,series,/.test(text)];
    const svg = new DOMParser().parseFromString(text, 'image/svg+xml');
    return ['svg', svg.querySelectorAll('svg.p').length, !svg.querySelector('parsererror') && svg.querySelectorAll('svg.p path.l, svg.p path.m').length > 0];
  }));
  assert.equal(checked.filter(c => c[0] === 'csv').length, with_numbers);
  for (const [kind, count, good] of checked) assert.ok(good && count > (kind === 'csv' ? 5 : 0), kind + ' ' + count);
  assert.deepEqual(complaints, []);
});

test('nothing scrolls sideways on a phone or at 200 %', async () => {
  for (const [width, inner] of [[390, true], [640, true], [800, false], [1280, false]]) {
    const {tab} = await open({width});
    await tab.evaluate(() => document.querySelectorAll('details').forEach(d => d.open = true));
    assert.ok(await tab.evaluate(() => document.documentElement.scrollWidth <= innerWidth), width + ' px: the page');
    if (inner) assert.deepEqual(await tab.$$eval('.scroll', es => es.filter(e => e.scrollWidth > e.clientWidth + 1).map(e => e.getAttribute('aria-label'))), [], width + ' px');
  }
});

test('axe finds nothing, light, dark and on a phone', async () => {
  for (const how of [{}, {dark: true}, {width: 390}]) {
    const {tab} = await open(how);
    await tab.evaluate(() => document.querySelectorAll('details').forEach(d => d.open = true));
    await tab.evaluate(axe);
    const found = await tab.evaluate(async () => (await axe.run()).violations.map(v => v.id + ': ' + v.nodes.slice(0, 3).map(n => n.html.slice(0, 120)).join(' ')));
    assert.deepEqual(found, [], JSON.stringify(how));
  }
});

test('screenshots and print', {skip: !out}, async () => {
  for (const width of [390, 800, 1280]) {
    const {tab} = await open({width});
    await tab.screenshot({path: `${out}/${width}.png`});
    for (const id of await tab.$$eval('figure, section', es => es.map(e => e.id)))
      await (await tab.$('#' + id)).screenshot({path: `${out}/${width}-${id}.png`});
    if (width === 1280) await tab.pdf({path: `${out}/print.pdf`, format: 'A4'});
  }
});
