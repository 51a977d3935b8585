// live/state/opening-speed.js: the speed that a session begins with.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {openingSpeed} from '../../frontend/live/state/opening-speed.js';

/** @import {Experiment} from '../../frontend/live/types.js' */

/** @param {number} horizon @param {number[]} onsets */
const speed = (horizon, ...onsets) => {
  const faults = /** @type {Experiment['faults']} */ (/** @type {unknown} */ (onsets.map((onset) => ({onset}))));
  return openingSpeed({horizon, faults});
};

test('the whole is over in a minute, and the first fault comes within ten seconds', () => {
  for (const [horizon, onsets] of /** @type {[number, number[]][]} */ ([
    [100, []],
    [100, [20, 45]],
    [1400, [300]],
    [3600, []],
    [20, [0, 90]],
  ])) {
    const chosen = speed(horizon, ...onsets) ?? NaN;
    const first = Math.min(...onsets.filter((onset) => onset > 0));
    // the next slower of the speeds that can be chosen: a factor of 2.5 lies between two of them at most
    const wanted = Math.min(100, Math.max(horizon / 50, Number.isFinite(first) ? first / 10 : 0));
    assert.ok(chosen <= wanted && chosen > wanted / 2.6, `${horizon} ${onsets}: ${chosen} for ${wanted}`);
  }
});

test('a short experiment does not begin slower than the slowest speed, and a long one not faster than 100', () => {
  assert.ok((speed(0.001) ?? 0) > 0);
  assert.equal(speed(1e6), 100);
  assert.equal(openingSpeed({horizon: 5e5, faults: [], step: 250}), 5000); // rows that lie far apart
});
