// widgets/number-format.js, slider-scale.js, common/dom.js (number) and the numbers of the comparison.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {number} from '../../frontend/common/dom.js';
import {Form} from '../../frontend/live/panels/comparison/column-format.js';
import {fixed, power, seconds, SPEEDS, times} from '../../frontend/widgets/number-format.js';
import {ENDS, gainScale, linear, logarithmic, nice, position, value} from '../../frontend/widgets/slider-scale.js';

test('a number of fixed decimals has a true minus, no minus zero, and a power of ten where it would be long', () => {
  assert.deepEqual(
    [fixed(1.234, 2), fixed(-1.5, 1), fixed(-0.001, 2), fixed(2.5e7, 0), fixed(NaN, 2), fixed(-123456.789, 3)],
    ['1.23', '−1.5', '0.00', '2.5·10⁷', '–', '−1.2·10⁵'],
  );
  assert.deepEqual([power(0), power(3.2e-7), power(-4.56e12)], ['0', '3.2·10⁻⁷', '−4.6·10¹²']);
});

test('a number is written to four significant digits, and as a power of ten outside of 0.001 … 100 000', () => {
  assert.deepEqual(
    [number(0.0010004), number(12345), number(1e5), number(-0.00012), number(0), number(null), number(Infinity)],
    ['0.001', '12350', '1·10⁵', '−1.2·10⁻⁴', '0', '–', '–'],
  );
});

test('a time has as many decimals as the marks of its axis', () => {
  assert.deepEqual(
    [seconds(78.449), seconds(78.449, 1), seconds(3, 0.05), seconds(2, 500)],
    ['78.4', '78', '3.00', '2'],
  );
});

test('speeds rise, end with the fastest, and read as multiples', () => {
  const known = SPEEDS.slice(0, -1).map(Number);
  assert.deepEqual(
    known,
    [...known].sort((a, b) => a - b),
  );
  assert.deepEqual([times(0.1), times(10), times(SPEEDS[SPEEDS.length - 1])], ['0.1×', '10×', '∞']);
});

for (const [name, scale] of Object.entries({
  linear: linear(-2, 6),
  logarithmic: logarithmic(0.001, 1000),
  'logarithmic with a zero': logarithmic(0.5, 50, true),
})) {
  test(`on a ${name} scale a value keeps its place, and larger values stand further right`, () => {
    const places = Array.from({length: 201}, (_, k) => k * (ENDS / 200));
    const values = places.map((place) => value(scale, place));
    assert.ok(values.every((one, i) => i === 0 || one >= values[i - 1]));
    for (const [i, place] of places.entries())
      if (!scale.zero || place >= 20) assert.ok(Math.abs(position(scale, values[i]) - place) <= 5, `${place}`);
    assert.equal(position(scale, scale.max * 10), ENDS);
    assert.equal(position(scale, scale.min), scale.zero ? 20 : 0);
  });
}

test('a scale with a zero gives exactly zero at its left end', () => {
  assert.deepEqual([value(logarithmic(1, 9, true), 0), value(logarithmic(1, 9, true), 19)], [0, 0]);
  assert.equal(position(logarithmic(1, 9, true), 0), 0);
});

test('the scale of a gain lies within its bounds and holds its default', () => {
  /** @type {[number | null, number | null, number][]} */
  const cases = [
    [0, 1, 0.5],
    [0, 1e15, 2],
    [1e-9, 1e9, 4],
    [-1e6, 1e6, -3],
    [0.001, 1000, 999],
    [0, null, 3e-14],
    [null, null, -3.5e7],
  ];
  for (const [low, high, begin] of cases) {
    const scale = gainScale({low, high}, begin);
    assert.ok(scale.min >= (low ?? -Infinity) && scale.max <= (high ?? Infinity) && scale.min < scale.max);
    assert.ok(begin >= scale.min && begin <= scale.max, `${begin} in ${scale.min} … ${scale.max}`);
    assert.ok(low === null || low < 0 || scale.kind === 'linear' || scale.zero === (low === 0));
  }
});

test('a gain that must be positive has no zero on its scale', () => {
  assert.equal(gainScale({low: 0, high: null, positive: true}, 2).zero, false);
});

test('a nice number is 1, 2 or 5 times a power of ten, within a factor of 2.5', () => {
  for (const one of [0.013, 0.02, 0.4, 1, 3, 7.4, 7.6, 99, -250, 6e8]) {
    const found = nice(one);
    assert.match(Math.abs(found).toExponential(), /^[125]e/);
    assert.ok(found / one > 0.4 && found / one < 2.5, `${one} → ${found}`);
  }
  assert.deepEqual([nice(0), nice(NaN)], [0, 0]);
});

test('all numbers of a column have one form: powers of ten or not, with as many decimals', () => {
  const written = [
    [0.00033, 0.0107],
    [0.00007, 0.5],
    [0.5, 0.76],
    [2e6, 3],
  ].map((values) => {
    const form = new Form();
    form.take(values);
    return values.map((one) => form.write(one));
  });
  assert.deepEqual(written, [
    ['0.00033', '0.01070'],
    ['7.0·10⁻⁵', '5.0·10⁻¹'],
    ['0.50', '0.76'],
    ['2.0·10⁶', '3.0·10⁰'],
  ]);
});

test('a clock of a fast plant shows powers of ten with the digits of its axis', () => {
  assert.equal(seconds(78.43, 0.1), '78.4');
  assert.equal(seconds(3.14159e-6, 1e-8), '3.14·10⁻⁶');
  assert.equal(seconds(0, 1e-8), '0.0000');
});
