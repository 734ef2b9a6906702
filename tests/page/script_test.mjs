// The script of the page by itself, without a browser: node --test tests/page/script_test.mjs
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import test from 'node:test';

const path = new URL('../../app/report/page_script.js', import.meta.url).pathname;
const script = createRequire(import.meta.url)(path);

// As app/CMakeLists.txt builds it in: without comments of whole lines, the line that lets this file load it, and indentation.
test('the script is at most 15 kB in the page', () => {
  const built_in = readFileSync(path, 'utf8').split('\n').map(line => line.trim()).filter(line => !/^(\/\/|if .typeof module)/.test(line)).join('\n');
  assert.ok(built_in.length <= 15360, String(built_in.length));
});

test('numbers are unpacked to five digits of their range, undefined ones to null', () => {
  // 0, 262142, 131071 and 262143 of 18 bits, in characters of six
  assert.deepEqual(script.unpack([-1, 3, 'AAA' + '//+' + 'f//' + '///']), [-1, 3, 1, null]);
  assert.deepEqual(script.unpack([7, 7, 'AAA']), [7]);
  const [low, high, middle] = script.unpack([Math.log(1e-4), Math.log(1e2), 'AAA' + '//+' + 'f//', 1]);
  assert.deepEqual([low, high, middle], [1e-4, 100, 0.1]);
});

const labels = ticks => ticks.filter(t => t[1] !== '').map(t => t[1] + (t[2] ? 'e' + t[2] : ''));

test('ticks are round and within the axis', () => {
  assert.deepEqual(labels(script.ticks({from: 0, to: 1, log: 0}, 5)), ['0.0', '0.2', '0.4', '0.6', '0.8', '1.0']);
  assert.deepEqual(labels(script.ticks({from: -0.011, to: 0.021, log: 0}, 3)), ['\u22120.01', '0.00', '0.01', '0.02']);
  assert.deepEqual(labels(script.ticks({from: 1234, to: 1236, log: 0}, 4)), ['1234.0', '1234.5', '1235.0', '1235.5', '1236.0']);
  for (let k = 0; k < 200; ++k) {
    const from = Math.sin(k) * 10 ** (k % 6 - 4), axis = {from, to: from + 10 ** (k % 9 - 4), log: 0};
    const list = script.ticks(axis, 5);
    assert.ok(list.length >= 2 && list.length <= 12, JSON.stringify([axis, list]));
    for (const [v] of list) assert.ok(script.fraction(axis, v) > -1e-6 && script.fraction(axis, v) < 1 + 1e-6);
    const steps = list.slice(1).map(([v], i) => v - list[i][0]);
    for (const step of steps) assert.ok(Math.abs(step / steps[0] - 1) < 1e-6);
  }
});

test('a logarithmic axis has ticks at decades, and within a decade at round values', () => {
  assert.deepEqual(labels(script.ticks({from: 1e-3, to: 10, log: 1}, 5)), ['10e\u22123', '10e\u22122', '10e\u22121', '10e0', '10e1']);
  assert.deepEqual(labels(script.ticks({from: 1, to: 5, log: 1}, 4)), ['1', '2', '3', '4', '5']);
  const axis = {from: 1e-3, to: 10, log: 1};
  assert.ok(Math.abs(script.value_at(axis, script.fraction(axis, 0.02)) - 0.02) < 1e-12);
});

test('numbers are said with five digits and a true minus', () => {
  assert.equal(script.say(-0.123456), '\u22120.12346');
  assert.equal(script.say(1234567), '1234600');
  assert.equal(script.say(0.5), '0.5');
});

const figure = () => script.read_figure({
  arrays: [[0, 1, 'AAA//+///'], [10, 20, 'AAA//+AAA'], [0, 0.5, 'AAA//+AAA']],
  panels: [{title: 'a, "b"', x: ['x [\u2013]', 0, 1, 0], y: ['y', 0, 30, 0], series: [
    {label: '', x: 0, y: 1}, {label: 'DEM', x: 0, y: 1, bands: [2]}]}]});

test('a figure is one point a line, quoted where it must be, without series that have no name', () => {
  assert.equal(script.csv(figure()).split('\n').slice(1).join('\n'),
    '"a, ""b""",DEM,2,x [\u2013],y,0,10,,0,\n"a, ""b""",DEM,2,x [\u2013],y,1,20,,0.5,\n"a, ""b""",DEM,2,x [\u2013],y,,10,,0,\n');
});

test('cells sort as numbers, then as words, empty ones last either way', () => {
  const cells = ['b', 10, '', 9, 'a', -1];
  assert.deepEqual([...cells].sort((a, b) => script.compare(a, b, false)), [-1, 9, 10, 'a', 'b', '']);
  assert.deepEqual([...cells].sort((a, b) => script.compare(a, b, true)), ['b', 'a', 10, 9, -1, '']);
});
