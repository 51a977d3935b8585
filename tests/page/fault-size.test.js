// diagnosis/fault-size.js: sizes of faults with their intervals.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {amount, small, unresolved} from '../../frontend/diagnosis/fault-size.js';

/** @import {Diagnosis} from '../../frontend/live/types.js' */

test('a size has as many decimals as its interval justifies, and both share one power of ten', () => {
  for (const [size, half, text] of /** @type {[number, number | null, string][]} */ ([
    [0.02, 0.0004, '+0.0200 ± 0.0004'],
    [-1.25, 0.012, '−1.250 ± 0.012'],
    [3, 0.9, '+3.0 ± 0.9'],
    [-2.5e-6, 1e-7, '−2.50 ± 0.10 ·10⁻⁶'],
    [0.02, null, '+0.02000'],
  ]))
    assert.equal(amount({size, half}), text);
  assert.equal(amount({size: null, half: null}), '–');
});

test('a small number is short and has no power of ten where it can be read without', () => {
  assert.deepEqual(
    [small(0.012345), small(1234.5, 3), small(-0.5), small(0), small(null)],
    ['0.012', '1230', '-0.5', '0', '–'],
  );
});

test('a channel is called not identifiable only while no alarm names it alone', () => {
  const resolution = ['a', 'b'].map((channel) => ({channel, identifiable: false, resolvable: false}));
  const diagnosis = /** @type {Diagnosis} */ (/** @type {unknown} */ ({calibration: {from_time: 1}, resolution}));
  /** @param {...{subjects: string[], over: number | null}} alarms */
  const of = (...alarms) =>
    unresolved({t: 9, alarms, diagnosis})
      .map(({channel}) => channel)
      .join('');
  assert.deepEqual(
    [of(), of({subjects: ['a'], over: null}), of({subjects: ['a'], over: 8}), of({subjects: ['a', 'b'], over: null})],
    ['ab', 'b', 'ab', 'ab'],
  );
  assert.deepEqual(unresolved({t: 0.5, alarms: [], diagnosis}), [], 'before anything is judged');
});
