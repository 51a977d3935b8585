// live/state/samples.js: a ring of rows with minima and maxima of bins.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Samples} from '../../frontend/live/state/samples.js';
import {randomNumbers, samplesOf} from './helpers.js';

test('at every level the bins are the true minima and maxima, also after a rewind and beyond the capacity', () => {
  const samples = new Samples(0.01, 4 * 16384);
  samples.setColumns(['a']);
  /** @type {number[]} */
  const rows = [];
  const random = randomNumbers(1);
  /** @param {number} count */
  const push = (count) => {
    const data = Float32Array.from({length: count}, random);
    data.forEach((value, i) => (rows[samples.rows + i] = value));
    samples.push(samples.rows, count, data);
  };
  while (samples.rows < 70_000) push(1 + Math.floor(random() * 900));
  samples.truncate(64_321);
  rows.length = 64_321;
  while (samples.rows < 66_000) push(1 + Math.floor(random() * 90));
  assert.equal(samples.capacity, 16384);
  for (let power = 0; power <= 12; power += 1) {
    const source = samples.source('a', power);
    if (!source) throw new Error('no column a');
    const {low, high, mask} = source;
    const each = 2 ** power;
    const parts = each / source.rows;
    const first = Math.ceil(samples.reach(power) / each);
    assert.ok((first + 1) * each <= samples.rows, `no bin at power ${power}`);
    for (let bin = first; (bin + 1) * each <= samples.rows; bin += 7) {
      const own = rows.slice(bin * each, (bin + 1) * each);
      /** @type {number[]} */
      const places = Array.from({length: parts}, (_, j) => (bin * parts + j) & mask);
      assert.equal(Math.min(...places.map((i) => low[i])), Math.min(...own));
      assert.equal(Math.max(...places.map((i) => high[i])), Math.max(...own));
    }
  }
});

test('a row has its value until it is truncated or overwritten', () => {
  const samples = samplesOf({a: [1, 2, 3, 4], b: [5, 6, 7, 8]}, 0.5);
  assert.equal(samples.now, 1.5);
  assert.deepEqual([samples.latest('a'), samples.at('b', 0.5), samples.at('a', 99)], [4, 6, NaN]);
  samples.truncate(2);
  assert.deepEqual([samples.rows, samples.latest('a'), samples.at('a', 1)], [2, 2, NaN]);
  samples.push(1, 1, Float32Array.from([20, 60]));
  assert.deepEqual([samples.value('a', 1), samples.value('b', 1)], [20, 60]);
});

test('rows that were not sent are missing values, and do not count in a range', () => {
  const samples = samplesOf({a: [1, 2]});
  samples.push(5, 2, Float32Array.from([10, 20]));
  assert.deepEqual([samples.value('a', 3), samples.rows], [NaN, 7]);
  assert.deepEqual(samples.range('a', 0, 6), {min: 1, max: 20, mean: 8.25, count: 4});
});

test('derived columns follow the columns they are computed from', () => {
  const samples = new Samples(1);
  samples.setColumns(
    ['y', 'o.y'],
    [
      {name: 'residual', of: ['y', 'o.y'], make: (a, b) => a - b},
      {name: 'lost', of: ['y', 'missing'], make: () => 1},
    ],
  );
  samples.push(0, 2, Float32Array.from([5, 7, 1, 2]));
  assert.deepEqual([samples.value('residual', 0), samples.value('residual', 1)], [4, 5]);
  assert.equal(samples.has('lost'), false, 'a column without its sources does not exist');
});

test('a column that stays keeps its rows when the columns change', () => {
  const samples = samplesOf({a: [1, 2], b: [3, 4]});
  samples.setColumns(['b', 'c']);
  assert.deepEqual([samples.has('a'), samples.value('b', 1), samples.value('c', 1)], [false, 4, NaN]);
});

test('the bins of a picture are at least a pixel wide and reach back to its first row', () => {
  const samples = new Samples(1, 4 * 4096);
  samples.setColumns(['a']);
  samples.push(0, 100_000, new Float32Array(100_000));
  for (const [first, last, pixels] of [
    [99_000, 100_000, 2000],
    [90_000, 100_000, 500],
    [0, 100_000, 700],
    [0, 100_000, 1e6],
  ]) {
    const power = samples.power(first, last, pixels);
    assert.ok(2 ** power >= (last - first) / pixels);
    assert.ok(samples.reach(power) <= first);
  }
});
