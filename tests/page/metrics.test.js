// live/panels/comparison/metrics.js: the figures by which observers are compared.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {noise, rmse, settled, unsettled} from '../../frontend/live/panels/comparison/metrics.js';

const t = Float64Array.from({length: 100}, (_, k) => 5 + k);
const truth = new Float32Array(100).fill(1);

test('an estimate has settled when every later row is within the band', () => {
  /** @param {...number} outside */
  const of = (...outside) =>
    settled(
      t,
      truth,
      Float32Array.from(truth, (_, k) => (outside.includes(k) ? NaN : 1.05)),
      5,
      0.1,
    );
  assert.deepEqual([of(), of(0, 1, 2), of(0, 50), of(95)], [0, 3, 51, null]);
});

test('an estimate that noise alone keeps out of the band is noisy, one that has not arrived is not', () => {
  const time = Float64Array.from({length: 1000}, (_, k) => k / 100);
  const one = new Float32Array(1000).fill(1);
  /** @param {(at: number, k: number) => number} make */
  const course = (make) => Float32Array.from(time, (at, k) => make(at, k));
  /** @param {number} k */
  const wave = (k) => Math.sin(1.7 * k) + Math.sin(0.61 * k);
  const found = [
    course((_, k) => 1 + 0.1 * wave(k)),
    course(() => 0.5),
    course((at) => 1 - Math.exp(-at)),
    course((_, k) => 0.7 + 0.1 * wave(k)),
  ].map((mine) => [settled(time, one, mine, 0, 0.1) === null, unsettled(time, one, mine, 0.1)]);
  assert.deepEqual(found, [
    [true, true],
    [true, false],
    [false, false],
    [true, false],
  ]);
});

test('a root mean square error leaves out missing values', () => {
  assert.equal(rmse(Float32Array.of(1, NaN, 5), Float32Array.of(1, 2, 2)), Math.sqrt(4.5));
  assert.equal(rmse(Float32Array.of(NaN), Float32Array.of(1)), NaN);
});

test('noise is the spread about a straight line, so a ramp has none', () => {
  assert.ok(
    noise(
      t,
      Float32Array.from(t, (at) => 3 * at - 7),
    ) < 1e-3,
  );
  const wave = noise(
    t,
    Float32Array.from(t, (at, k) => 3 * at + (k % 2 ? 1 : -1)),
  );
  assert.ok(Math.abs(wave - 1) < 0.01, `${wave}`);
  assert.equal(noise(t, Float32Array.of(1, 2)), NaN);
});
