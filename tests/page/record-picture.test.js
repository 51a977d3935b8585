// pages/records: curves, the healthy stretch, numbers with intervals, and the files that are downloaded.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {findingsCsv} from '../../frontend/pages/records/findings/findings-csv.js';
import {yamlOf} from '../../frontend/pages/records/fit/plant-yaml.js';
import {destination, moved} from '../../frontend/pages/records/fit/stretch.js';
import {percent, span, withInterval} from '../../frontend/pages/records/numbers.js';
import {
  apart,
  area,
  heights,
  line,
  path,
  range,
  rangeOfCurves,
  widened,
} from '../../frontend/pages/records/picture/curves.js';

test('an axis shows all values, its line, and nothing beyond the largest that is asked for', () => {
  const [low, high] = range([1, null, 2], [3, null, 9]);
  assert.ok(low < 1 && high > 9);
  assert.ok(range([1], [2], {line: 30})[1] > 30);
  assert.ok(range([1, 1], [1, 500], {most: 4})[1] < 5);
  assert.ok(range([1e-9], [400], {logarithmic: true})[0] > 1e-3);
  assert.deepEqual(range([null], [null]), [0, 1]);
});

test('heights grow downwards, also on a logarithmic axis', () => {
  assert.deepEqual([0, 5, 10].map(heights([0, 10])), [100, 50, 0]);
  assert.deepEqual([1, 10, 100, 1e9].map(heights([1, 100], true)), [100, 50, 0, 0]);
});

test('a path runs through both ends of each interval, and is broken where there are no data', () => {
  const height = heights([0, 10]);
  assert.equal(path([0, 5], [0, 10], height), 'M0.0 100.0L500.0 50.0V0.0');
  assert.equal(path([0, null, null, 5], [0, null, null, 5], height), 'M0.0 100.0M750.0 50.0');
  assert.equal(path([0, null, 5], [0, null, 5], height), 'M0.0 100.0L666.7 50.0');
  assert.equal(path([0, 10], [0, 10], height, true), 'M0.0 100.0H500.0V0.0H1000');
});

test('a second curve is drawn at its own times, and widens the axis by at most its width', () => {
  assert.equal(line([0, 5, 10, 20], [0, 10, null, 5], 20, heights([0, 10])), 'M0.0 100.0L250.0 0.0M1000.0 50.0');
  assert.deepEqual(widened([0, 10], [5, null, 12]), [0, 12]);
  assert.deepEqual(widened([0, 10], [-1e9, 1e9]), [-10, 20]);
});

test('marks keep their order and a distance, and stay within the picture', () => {
  const places = apart([0.5, 0.5, 0.1, 0.99, 0.99], 0.03);
  assert.ok(places[2] === 0.1 && places[0] < places[1] && places.every((one) => one >= 0 && one <= 1));
  const sorted = [...places].sort((a, b) => a - b);
  assert.ok(sorted.every((one, k) => k === 0 || one - sorted[k - 1] > 0.0299));
  const many = apart(Array(200).fill(0.5), 0.03);
  assert.ok(Math.min(...many) >= 0 && Math.max(...many) <= 1);
});

test('keys move an end of the stretch by a row or a minute, within the record', () => {
  const record = {duration: 599, period: 0.5};
  /** @param {string} key @param {boolean} [shiftKey] */
  const to = (key, shiftKey = false) => destination({key, shiftKey}, 100, record);
  assert.deepEqual([to('ArrowLeft'), to('ArrowRight'), to('ArrowRight', true)], [99.5, 100.5, 160]);
  assert.deepEqual([to('Home'), to('End'), to('x')], [0, 599, null]);
  assert.deepEqual(moved({begin: 10, end: 20}, 'begin', 99, record), {begin: 19.5, end: 20});
  assert.deepEqual(moved({begin: 10, end: 20}, 'end', -5, record), {begin: 10, end: 10.5});
  assert.deepEqual(moved({begin: 10, end: 20}, 'end', 12.26, record), {begin: 10, end: 12.5});
});

test('an interval gives the number of decimals', () => {
  assert.equal(withInterval({value: 1.0012, low: 0.9822, high: 1.0202}), '1.001 ± 0.019');
  assert.equal(withInterval({value: 300, low: 299.5, high: 300.5}), '300.0 ± 0.5');
  assert.equal(withInterval({value: -0.0004, low: -0.03, high: 0.0292}), '0.00 ± 0.03');
  assert.equal(withInterval({value: 1, low: 0.4, high: 3.2}), '1.00 (0.40 … 3.20)');
  assert.equal(withInterval({value: 2, low: 2, high: 2}), '2');
  assert.equal(withInterval({value: 2.5e-5, low: 2.4e-5, high: 2.6e-5}), '2.5·10⁻⁵ ± 1·10⁻⁶');
  assert.deepEqual([percent(0.9771), percent(null)], ['97.7\u202f%', '–']);
  assert.deepEqual([599, 2700, 7200, 300000].map(span), ['599\u202fs', '45\u202fmin', '2\u202fh', '3.47\u202fd']);
});

const interval = {value: 1, low: 0.9, high: 1.1};
const candidate = {
  ...{
    channel: 'offset',
    title: {code: '', args: {}, text: 'sensor offset'},
    unit: 'cm',
    shape: /** @type {const} */ ('step'),
    rate: 0,
    bound: null,
  },
  ...{onset: interval, size: interval, behind: 0, separable: true, text: {code: '', args: {}, text: ''}},
};

test('findings are a table with a line for each explanation', () => {
  const fault = {
    ...{id: 'fault-1', best: candidate, alternatives: [{...candidate, channel: 'leak', unit: 'a,b', separable: false}]},
    ...{alarm: 3, statistic: 40, ended: null, confirmed: true, covered: true, text: candidate.text, note: null},
  };
  const [head, best, other, end] = findingsCsv([fault]).split('\n');
  assert.equal(head.split(',').length, 18);
  assert.equal(best, 'fault-1,best,offset,step,1,0.9,1.1,1,0.9,1.1,cm,0,,3,,true,true,true');
  assert.ok(other.startsWith('fault-1,alternative,leak') && other.includes('"a,b"') && end === '');
});

test('a plant is written as YAML: short parts in a line, texts in quotes where needed, empty parts left out', () => {
  const plant = {
    ...{id: 'tank', title: 'yes', description: '', time: {kind: 'continuous', period: null}, references: []},
    states: [{name: 'h', unit: '', initial: 20, domain: [0, null], description: `a level: ${'long '.repeat(25)}`}],
    dynamics: {h: '(q - out)/A', y: '-1e-7*h'},
    parameters: [{name: 'A', value: 1e-7, unit: 'cm²'}],
  };
  const text = yamlOf(plant);
  assert.ok(
    text.startsWith('id: tank\ntitle: "yes"\ntime: {kind: continuous}\nstates:\n  -\n    name: h\n    unit: ""\n'),
  );
  assert.ok(
    text.includes('    domain: [0, null]\n') && text.includes('parameters: [{name: A, value: 1.0e-7, unit: cm²}]\n'),
  );
  assert.ok(text.includes('dynamics: {h: "(q - out)/A", "y": "-1e-7*h"}\n'));
});

test('the area of a band is closed, and has a part for each stretch without a gap', () => {
  const height = heights([0, 10]);
  const drawn = area([0, 1, 2, 3, 4], [0, 0, null, 0, 0], [10, 10, 10, 10, 10], 4, height);
  assert.equal(drawn, 'M0.0 100.0L250.0 100.0L250.0 0.0L0.0 0.0ZM750.0 100.0L1000.0 100.0L1000.0 0.0L750.0 0.0Z');
  assert.equal(area([0, 1], [null, 1], [1, 2], 1, height), '', 'a single row has no area');
});

test('the range of estimates leaves out how they settle, and shows zero', () => {
  const values = Array.from({length: 100}, (_, k) => (k < 10 ? 1000 : 2));
  const [low, high] = rangeOfCurves([{values}], true);
  assert.ok(low < 0 && high > 2 && high < 3);
  assert.ok(rangeOfCurves([{values}])[0] > 1, 'without zero the axis begins near the values');
});
