// What the page of a calibration does beyond being read: values under the pointer, zoom, keys, sorted tables, downloads, links
// into folds. Everything is drawn without it; it reads the numbers that stand in the page and asks for nothing from outside.
(function () {
'use strict';

const ALPHABET = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';

// [lowest, highest, three characters a value, 1: logarithms] as page_figure.cpp packs it; null: undefined. Rounded to what three
// characters hold.
function unpack([lowest, highest, text, log]) {
  const step = (highest - lowest) / 262142;
  const decimals = Math.min(20, Math.max(0, Math.ceil(-Math.log10(step))));
  return (text.match(/.../g) || []).map(three => {
    const code = [...three].reduce((sum, c) => 64 * sum + ALPHABET.indexOf(c), 0), value = lowest + step * code;
    return code === 262143 ? null : log ? +Math.exp(value).toPrecision(5) : step ? +value.toFixed(decimals) : lowest;
  });
}

// A number as a reader wants it: five digits, a true minus.
const say = value => String(+value.toPrecision(5)).replace('-', '−');

const fraction = (axis, v) => axis.log ? Math.log(v / axis.from) / Math.log(axis.to / axis.from)
                                       : (v - axis.from) / (axis.to - axis.from);
const value_at = (axis, f) => axis.log ? axis.from * Math.pow(axis.to / axis.from, f)
                                       : axis.from + f * (axis.to - axis.from);

// Round values within the axis, [value, label, exponent of ten where the label is one], as axis.cpp makes them.
function ticks({from, to, log}, wanted) {
  const list = [], floor = Math.floor, minus = text => text.replace('-', '−');
  if (log && to / from > 30) {
    const first = Math.ceil(Math.log10(from) - 1e-9), last = floor(Math.log10(to) + 1e-9);
    const stride = Math.max(1, Math.ceil((last - first) / wanted));
    for (let k = first; k <= last; ++k) list.push([10 ** k, ...(k - first) % stride ? ['', ''] : ['10', minus(String(k))]]);
    return list;
  }
  const raw = (to - from) / wanted, decade = 10 ** floor(Math.log10(raw)), m = raw / decade;
  const step = (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10) * decade;
  const decimals = Math.max(0, -floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; ++k) {
    const v = k * step || 0;
    list.push([v, decimals > 5 || Math.abs(v) >= 1e6 ? say(v) : minus(v.toFixed(decimals)), '']);
  }
  return list;
}

// The numbers of a figure, one point a line.
function csv(figure) {
  const quote = text => /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
  const lines = ['panel,series,number,abscissa,ordinate,x,y,standard error,band,second band'];
  for (const panel of figure.panels) {
    // runs of several packings share a label
    panel.series.forEach((s, k) => {
      if (s.label) s.x.forEach((x, i) => lines.push([quote(panel.title), quote(s.label), k + 1, quote(panel.x.label),
        quote(panel.y.label), x, s.y[i], ...[s.error, s.bands[0], s.bands[1]].map(list => list ? list[i] : '')].join(',')));
    });
  }
  return lines.join('\n') + '\n';
}

// Order of two cells: numbers ascending, then words; what is empty comes last either way.
function compare(a, b, descending) {
  const kind = v => v === '' ? 2 : typeof v === 'number' ? 0 : 1;
  const order = kind(a) - kind(b) || (kind(a) ? a.localeCompare(b) : a - b);
  return descending && a !== '' && b !== '' ? -order : order;
}

// A figure's data with its numbers unpacked.
function read_figure(data) {
  const unpacked = {};
  const numbers = index => index === undefined ? undefined : unpacked[index] ||= unpack(data.arrays[index]);
  const axis = ([label, from, to, log]) => ({label, from, to, log, all: [from, to]});
  for (const panel of data.panels) {
    panel.x = axis(panel.x);
    panel.y = axis(panel.y);
    for (const s of panel.series) {
      s.x = numbers(s.x);
      s.y = numbers(s.y);
      s.error = numbers(s.error);
      s.bands = (s.bands || []).map(b => numbers(b));
    }
  }
  return data;
}

if (typeof module === 'object') module.exports = {unpack, say, ticks, csv, compare, read_figure, fraction, value_at};
if (typeof document === 'undefined') return;

// --- figures ------------------------------------------------------------------------------------------------------------

const make = (tag, attributes, parent, text = '') => {
  const element = document.createElement(tag);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  element.append(text);
  parent?.append(element);
  return element;
};
const px = (p, v) => p.left + p.width * Math.min(4, Math.max(-3, fraction(p.x, v)));
const py = (p, v) => p.top + p.height * (1 - Math.min(4, Math.max(-3, fraction(p.y, v))));
const defined = (axis, v) => v !== null && isFinite(v) && (!axis.log || v > 0);
const inside = (axis, v) => Math.abs(fraction(axis, v) - .5) < .5 + 1e-6;
const at = (x, y) => x.toFixed(1) + ' ' + y.toFixed(1);

// Grid, ticks and numbers anew, then each path of each series, as svg_series.cpp draws them.
function redraw(p) {
  let grid = '', marks = '', words = '';
  const bottom = p.top + p.height, right = p.left + p.width;
  const word = (x, y, anchor, [, label, exponent]) => words += `<text x="${x}" y="${y}" text-anchor="${anchor}">${label}` +
    (exponent && `<tspan dy="-5" font-size="75%">${exponent}</tspan>`) + '</text>';
  for (const tick of ticks(p.x, Math.max(3, Math.floor(p.width / 60)))) {
    const x = px(p, tick[0]).toFixed(1);
    grid += `M${x} ${p.top}V${bottom}`;
    marks += `M${x} ${bottom}v5`;
    word(x, bottom + 18, 'middle', tick);
  }
  for (const tick of ticks(p.y, 5)) {
    const y = py(p, tick[0]);
    grid += `M${at(p.left, y)}H${right}`;
    marks += `M${at(p.left, y)}h-5`;
    word(p.left - 8, (y + 4).toFixed(1), 'end', tick);
  }
  if (p.zero && p.y.from < 0 && p.y.to > 0) marks += `M${at(p.left, py(p, 0))}H${right}`;
  p.scale.innerHTML = `<path class="grid" d="${grid}"/><path class="axis" d="${marks}"/>` + words;
  for (const s of p.series) {
    const low = s.bands.map(() => []), high = s.bands.map(() => []), shapes = s.bands.map(() => '');
    let line = '', marker = '', bars = '', pen = 'M';
    for (let i = 0; i <= s.x.length; ++i) {
      const shown = i < s.x.length && defined(p.x, s.x[i]) && defined(p.y, s.y[i]), x = shown && px(p, s.x[i]), v = s.y[i];
      s.bands.forEach((band, k) => {
        if (shown && band[i] !== null && defined(p.y, v - band[i])) {
          low[k].push(at(x, py(p, v - band[i])));
          high[k].unshift(at(x, py(p, v + band[i])));
          return;
        }
        if (low[k].length > 1) shapes[k] += `M${low[k].concat(high[k]).join('L')}z`;
        low[k] = [], high[k] = [];
      });
      if (!shown) { pen = 'M'; continue; }
      const place = at(x, py(p, v)), e = s.error?.[i];
      line += pen + place;
      pen = 'L';
      if (inside(p.x, s.x[i]) && inside(p.y, v)) marker += (marker ? 'L' : 'M') + place;
      if (e > 0 && defined(p.y, v - e))
        for (const end of [py(p, v - e), py(p, v + e)]) bars += `M${at(x - 2.5, end)}h5M${place}L${at(x, end)}`;
    }
    const paths = {b: shapes, e: [bars], l: [line], m: [marker.includes('L') ? marker : marker && marker + 'h0']};
    for (const c in paths) s.paths[c].forEach((path, k) => path.setAttribute('d', paths[c][k]));
  }
}

// Shows the part `fs` of x and `gs` of y, fractions of what is shown: of panel `p` and of all that have the same axis, or without
// `p` of every panel. Never more than the whole.
function zoom(fig, p, fs, gs) {
  const changes = [];
  for (const q of fig.panels) {
    for (const [axis, like, part] of [[q.x, (p || q).x, fs], [q.y, (p || q).y, gs]]) {
      if (axis.label === like.label && axis.from === like.from && axis.to === like.to)
        changes.push([axis, Math.max(axis.all[0], value_at(axis, part[0])), Math.min(axis.all[1], value_at(axis, part[1]))]);
    }
  }
  for (const [axis, from, to] of changes) {
    const part = v => fraction({...axis, from: axis.all[0], to: axis.all[1]}, v);
    if (part(to) - part(from) > 1e-4) axis.from = from, axis.to = to;
  }
  fig.panels.forEach(redraw);
  unmark(fig);
}
const whole = fig => zoom(fig, undefined, [-1e9, 1e9], [-1e9, 1e9]);

const visible = s => !s.box || s.box.checked;
// A strip or a floor without a name has no points to read.
const named = s => s.label && visible(s);
const can_show = (p, s, i) => defined(p.x, s.x[i]) && defined(p.y, s.y[i]) && inside(p.x, s.x[i]) && inside(p.y, s.y[i]);

// The point nearest to a place [px]: {s, i}, undefined where none is within `reach`.
function nearest(p, x, y, reach) {
  let best, least = reach * reach;
  for (const s of p.series) {
    if (!named(s)) continue;
    for (let i = 0; i < s.x.length; ++i) {
      if (!can_show(p, s, i)) continue;
      const d = (px(p, s.x[i]) - x) ** 2 + (py(p, s.y[i]) - y) ** 2;
      if (d < least) least = d, best = {s, i};
    }
  }
  return best;
}

function words_of(p, {s, i}) {
  const said = (axis, v, more) => {
    const [, name, unit] = axis.label.match(/^(.*?) *(?:\[(.*)\])?$/);
    return `${name} ${say(v)}${more}${unit && unit !== '–' ? ' ' + unit : ''}`;
  };
  const more = (s.error?.[i] > 0 ? ' ± ' + say(s.error[i]) : '') + (s.bands[0]?.[i] ? ', band ± ' + say(s.bands[0][i]) : '');
  return `${s.label && s.label + ': '}${said(p.x, s.x[i], '')}, ${said(p.y, s.y[i], more)}`;
}

const tip = make('div', {class: 'tip', 'aria-hidden': true, hidden: ''}, document.body);
function unmark(fig) {
  tip.hidden = true;
  fig.panels.forEach(p => p.over.innerHTML = '');
}
function mark(fig, p, point) {
  unmark(fig);
  const {s, i} = p.point = point;
  p.over.innerHTML = `<circle class="ring" r="7" cx="${px(p, s.x[i])}" cy="${py(p, s.y[i])}"/>`;
  tip.textContent = words_of(p, point);
  tip.hidden = false;
  const ring = p.over.getBoundingClientRect(), room = document.body.clientWidth - tip.offsetWidth;
  tip.style.left = Math.max(4, Math.min(room, ring.left + 14)) + 'px';
  tip.style.top = ring.top + scrollY - tip.offsetHeight - 4 + 'px';
}

// Arrows go along a series and from one to the next, + and - zoom about the point, Escape shows the whole range.
function press(fig, p, event) {
  const key = event.key, points = s => s.x.map((_, i) => i).filter(i => can_show(p, s, i));
  const list = p.series.filter(s => named(s) && points(s).length);
  let {s, i} = list.includes(p.point?.s) ? p.point : {s: list[0]};
  let said = '';
  if (key === 'Escape') {
    whole(fig);
  } else if (/^[-+=]$/.test(key) && !event.ctrlKey) {
    const about = (f, h = key === '-' ? 1 : .25) => [f - h, f + h];
    zoom(fig, p, about(i >= 0 ? fraction(p.x, s.x[i]) : .5), about(i >= 0 ? fraction(p.y, s.y[i]) : .5));
    said = 'Shown: ' + [p.x, p.y].map(axis => say(axis.from) + ' to ' + say(axis.to)).join(', ');
  } else if (/^(Arrow|Home|End)/.test(key) && s) {
    const shown = points(s), place = shown.indexOf(i), step = event.shiftKey ? 10 : 1;
    const next = {ArrowRight: place + step, ArrowLeft: place - step, Home: 0, End: 1e9}[key];
    if (next === undefined) {
      const x = s.x[i];
      s = list[(list.indexOf(s) + (key === 'ArrowUp' ? -1 : 1) + list.length) % list.length];
      i = points(s).reduce((a, b) => Math.abs(s.x[b] - x) < Math.abs(s.x[a] - x) ? b : a);
    } else {
      i = shown[Math.max(0, Math.min(shown.length - 1, next))];
    }
    mark(fig, p, {s, i});
    said = words_of(p, p.point);
  } else {
    return;
  }
  fig.readout.textContent = said;
  event.preventDefault();
}

function watch(fig, p) {
  const on = (type, act) => p.svg.addEventListener(type, act);
  let from, box = false;
  const place = e => {
    const {x, y} = new DOMPoint(e.clientX, e.clientY).matrixTransform(p.svg.getScreenCTM().inverse());
    return [x, y];
  };
  const end = () => { from = box = false; unmark(fig); };
  on('pointerdown', e => {
    if (e.button || e.pointerType !== 'mouse') return;
    from = place(e);
    e.preventDefault();
    p.svg.focus({preventScroll: true});
  });
  on('pointermove', e => {
    const [x, y] = place(e);
    if (box ||= from && Math.hypot(x - from[0], y - from[1]) > 5) {
      unmark(fig);
      p.over.innerHTML = `<path class="box" d="M${from}H${x}V${y}H${from[0]}z"/>`;
      return;
    }
    const point = nearest(p, x, y, 30);
    point ? mark(fig, p, point) : unmark(fig);
  });
  on('pointerup', e => {
    const part = (a, b) => a < b ? [a, b] : [b, a];
    if (box) {
      const [x, y] = place(e), f = v => (v - p.left) / p.width, g = v => 1 - (v - p.top) / p.height;
      zoom(fig, p, part(f(x), f(from[0])), part(g(y), g(from[1])));
    }
    end();
  });
  on('pointerleave', end);
  on('dblclick', () => whole(fig));
  on('keydown', e => press(fig, p, e));
  on('blur', end);
}

const save = (name, type, text) => {
  const link = make('a', {download: name, href: URL.createObjectURL(new Blob([text], {type}))});
  link.click();
};

// The figure as one file, as it is shown now: legend above, panels in their columns.
function svg_of(fig) {
  const boxes = fig.panels.map(p => p.svg.viewBox.baseVal), {width} = boxes[0], total = width * fig.columns;
  const height = Math.max(...boxes.map(b => b.height));
  const plain = text => text.replace(/[<&]/g, '');
  let x = 10, y = 14, out = '';
  for (const entry of fig.element.querySelectorAll('.legend > :not(.toggles)')) {
    if (entry.querySelector('input:not(:checked)') || !entry.getClientRects().length) continue;
    const text = entry.textContent.trim(), taken = 52 + 6.6 * text.length;
    if (x > 10 && x + taken > total) x = 10, y += 20;
    out += `<g transform="translate(${x} ${y - 12})">${entry.querySelector('svg > g').outerHTML}</g><text x="${x + 30}" y="${y}">${plain(text)}</text>`;
    x += taken;
  }
  const top = out ? y + 10 : 0;
  fig.panels.forEach((p, i) => {
    const copy = p.svg.cloneNode(true);
    copy.setAttribute('width', width);
    copy.setAttribute('height', height);
    copy.querySelectorAll('g.s').forEach((g, k) => visible(p.series[k]) || g.remove());
    out += `<g transform="translate(${i % fig.columns * width} ${top + Math.floor(i / fig.columns) * height})">${new XMLSerializer().serializeToString(copy)}</g>`;
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${total} ${top + height * Math.ceil(fig.panels.length / fig.columns)}">` +
    `<title>${plain(fig.title || '')}</title><style>${plain(document.querySelector('style').textContent)}svg{background:var(--ground)}</style>${out}</svg>\n`;
}

function start_figure(element) {
  const data = element.querySelector('script'), svgs = element.querySelectorAll('svg.p');
  if (!svgs.length) return;
  const tools = make('div', {class: 'tools'}), readout = make('output', {class: 'readout', 'aria-live': 'polite'});
  element.querySelector('figcaption').before(tools);
  let fig;
  // Numbers are unpacked when a figure is first touched.
  const awake = () => {
    if (fig) return fig;
    // A drawing has no numbers to point at.
    if (!data) return fig = {element, columns: 2, panels: [...svgs].map(svg => ({svg}))};
    fig = read_figure(JSON.parse(data.textContent));
    Object.assign(fig, {element, readout});
    fig.panels.forEach((p, i) => {
      p.svg = svgs[i];
      p.scale = p.svg.querySelector('g.a');
      const {x, y, width, height} = p.svg.querySelector('rect.axis').getBBox();
      Object.assign(p, {left: x, top: y, width, height});
      p.svg.querySelectorAll('g.s').forEach((g, k) => {
        const s = p.series[k];
        s.paths = {};
        for (const c of 'belm') s.paths[c] = g.querySelectorAll('.' + c);
        s.box = element.querySelector('.c' + s.toggle);
        g.querySelector('title').remove();
      });
      p.svg.insertAdjacentHTML('beforeend', '<g></g>');
      p.over = p.svg.lastChild;
      watch(fig, p);
    });
    return fig;
  };
  const button = (text, act) => make('button', {'aria-label': `${text}, ${element.id}`}, tools, text)
    .addEventListener('click', () => act(awake()));
  button('SVG', f => save(element.id + '.svg', 'image/svg+xml', svg_of(f)));
  if (!data) return;
  button('CSV', f => save(element.id + '.csv', 'text/csv', csv(f)));
  button('Zoom in', f => zoom(f, undefined, [.25, .75], [.25, .75]));
  button('Zoom out', f => zoom(f, undefined, [-.5, 1.5], [-.5, 1.5]));
  button('Whole', whole);
  tools.append(readout);
  svgs.forEach(svg => {
    svg.setAttribute('tabindex', 0);
    svg.setAttribute('role', 'application');
    svg.setAttribute('aria-roledescription', 'points: arrows read them, plus and minus zoom, Escape ends');
    for (const type of ['pointerenter', 'focus']) svg.addEventListener(type, awake, {once: true});
  });
}

// --- tables -------------------------------------------------------------------------------------------------------------

function start_table(table) {
  const body = table.tBodies[0], heads = [...table.tHead.rows[0].cells];
  if (body.rows.length < 3) return;
  const key = (row, column) => {
    const cell = row.cells[column], value = cell.dataset.value ?? cell.textContent.trim().replace('−', '-');
    return value === '' || isNaN(value) ? value : +value;
  };
  heads.forEach((head, column) => {
    if (!head.textContent) return;
    const button = make('button', {class: 'sort'});
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
  for (let e = target; e; e = e.parentElement) if (e.tagName === 'DETAILS') e.open = true;
  target?.scrollIntoView();
}

document.querySelectorAll('figure').forEach(start_figure);
document.querySelectorAll('table').forEach(start_table);
addEventListener('hashchange', unfold);
unfold();
})();
