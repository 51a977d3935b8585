// live/scope/axes.js and axis-view.js: round marks, calm ranges, and what an axis shows.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {marks, niceStep, quantiles, Range} from '../../frontend/live/scope/axes.js';
import {leaving, tickTexts, wanted} from '../../frontend/live/scope/axis-view.js';
import {Samples} from '../../frontend/live/state/samples.js';
import {randomNumbers, samplesOf} from './helpers.js';

/** @import {Strip} from '../../frontend/live/types.js' */

/**
 * A strip of one estimate.
 * @param {Partial<Strip>} more
 * @returns {Strip}
 */
const strip = (more = {}) => ({
  name: 'x.a',
  kind: 'state',
  symbol: 'a',
  subject: 'a',
  title: '',
  unit: '',
  truth: null,
  traces: [{label: 'o', colour: 'var(--o0)', place: 0, dashed: false, fallen: null, column: 'o.x.a'}],
  base: null,
  least: 0,
  log: false,
  threshold: null,
  weight: 1,
  usual: true,
  shown: true,
  ...more,
});

test('a step is 1, 2 or 5 times a power of ten, and about as many fit as were asked for', () => {
  for (const span of [1e-9, 0.037, 0.5, 1, 7, 99, 12345, 3e11])
    for (const count of [2, 4, 8]) {
      const step = niceStep(span, count);
      const lead = step / 10 ** Math.floor(Math.log10(step) + 1e-9);
      assert.ok(
        [1, 2, 5].some((one) => Math.abs(lead - one) < 1e-9),
        `${step}`,
      );
      assert.ok(span / step <= count * (1 + 1e-9) && span / step > count / 2.6, `${span} / ${step} for ${count}`);
    }
  for (const span of [0, -1, NaN, Infinity]) assert.equal(niceStep(span, 4), 1);
});

test('marks are the multiples of a step between two values, without rounding dust', () => {
  assert.deepEqual(marks(0, 0.3, 0.1), [0, 0.1, 0.2, 0.3]);
  assert.deepEqual(marks(-0.25, 0.25, 0.1), [-0.2, -0.1, 0, 0.1, 0.2]);
  assert.deepEqual(marks(3.1, 3.9, 1), []);
});

test('an axis keeps ahead of a value that grows, and moves seldom', () => {
  const range = new Range();
  let [outside, moves, before] = [0, 0, 0];
  range.aim(0, 1, 0, true);
  for (let k = 1; k <= 1200; k += 1) {
    const value = 1 + k / 100;
    if (k % 18 === 0) range.aim(0, value, k * 16);
    range.move(k * 16);
    const top = range.target?.[1] ?? NaN;
    if (top !== before) [moves, before] = [moves + 1, top];
    if (value > range.high) outside += 1;
  }
  assert.ok(outside < 0.2 * 1200, `${outside} outside`);
  assert.ok(moves <= 14, `${moves} moves`);
});

test('a throw sets the axis while it lasts; afterwards the axis recovers once, and noise moves it seldom', () => {
  const samples = new Samples(0.01);
  samples.setColumns(['o.x.a']);
  const random = randomNumbers(7);
  const range = new Range();
  const tall = () => (range.target ? range.target[1] - range.target[0] : NaN);
  let [before, moves, wide] = ['', 0, 0];
  for (let k = 0; k < 900; k += 1) {
    const thrown = k > 200 && k < 270 ? 6 : 0;
    samples.push(
      samples.rows,
      10,
      Float32Array.from({length: 10}, () => random() + random() + random() - 1.5 + thrown),
    );
    const [low, high] = wanted(strip(), samples, Math.max(0, samples.now - 30), samples.now);
    range.aim(low, high, k * 100);
    range.move(k * 100);
    wide = Math.max(wide, tall());
    if (k > 650 && String(range.target) !== before) moves += 1;
    before = String(range.target);
  }
  assert.ok(wide > 6 && tall() > 2 && tall() < 5 && moves <= 3, `${wide} ${tall()} ${moves}`);
});

test('the truth is always within the axis; of an estimate, what it does most of the time', () => {
  const truth = Array.from({length: 1000}, (_, k) => (k === 500 ? 9 : 1));
  const estimate = Array.from({length: 1000}, (_, k) => (k < 20 ? 50 : 1 + 0.1 * Math.sin(k)));
  const samples = samplesOf({'x.a': truth, 'o.x.a': estimate});
  const [low, high] = wanted(strip({truth: 'x.a'}), samples, 0, 999);
  assert.ok(low < 0.901 && high >= 9 && high < 50);
  const [, whole] = wanted(strip({truth: 'x.a'}), samples, 0, 999, true);
  assert.equal(whole, 50);
  const [left] = leaving(strip(), samples, 0, 999, [low, high]);
  assert.ok(left.up && left.from < 20 && left.to < 30, 'the throw at the start gets one mark');
  assert.equal(leaving(strip(), samples, 0, 999, [low, high]).length, 1);
});

test('the axis of a residual is symmetric about zero, and none is lower than its least height', () => {
  const samples = samplesOf({'o.x.a': [0.5, 0.5, 0.5]});
  assert.deepEqual(wanted(strip({kind: 'residual'}), samples, 0, 2), [-0.5, 0.5]);
  assert.deepEqual(wanted(strip({least: 4}), samples, 0, 2), [-1.5, 2.5]);
  assert.deepEqual(wanted(strip(), samples, 10, 12), [0, 1], 'without rows');
});

test('quantiles leave out as many values on either side, and ignore missing ones', () => {
  const values = [NaN, 5, 1, 2, 3, 4, NaN, 100, -100, 0];
  const bins = {low: values, high: values, each: 1, from: 0};
  assert.deepEqual(quantiles(bins, 0), [-100, 100]);
  assert.deepEqual(quantiles(bins, 0.125), [0, 5]);
  assert.equal(quantiles({...bins, low: [NaN], high: [NaN]}, 0), null);
  assert.equal(quantiles(null, 0), null);
});

test('the marks of an axis have at most seven characters, and one power of ten says what they leave out', () => {
  const digits = new Map([...'⁻⁰¹²³⁴⁵⁶⁷⁸⁹'].map((sign, place) => [sign, '-0123456789'[place]]));
  for (const [low, high] of [
    [0, 5e11],
    [-1e-7, 3e-7],
    [0.00739, 0.00742],
    [-1.5, 2],
    [9.99e5, 1.2e6],
    [-0.00004, 0.0011],
  ]) {
    const step = niceStep(high - low, 4);
    const ticks = marks(low, high, step);
    const [labels, power] = tickTexts(ticks, step);
    const unit = power ? 10 ** Number([...power.replace('·10', '')].map((sign) => digits.get(sign)).join('')) : 1;
    assert.ok(labels.every((label) => label.length <= 7) && new Set(labels).size === labels.length, labels.join());
    labels.forEach((label, i) => {
      const read = Number(label.replace('−', '-')) * unit;
      assert.ok(Math.abs(read - ticks[i]) <= Math.abs(ticks[ticks.length - 1]) * 1e-3, `${label} ${power}`);
    });
  }
});
