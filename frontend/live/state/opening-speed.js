// The speed that a session begins with.

import {SPEEDS} from '../../widgets/number-format.js';

/** @import {Experiment} from '../types.js' */

const PLAYED_IN = 50; // s in which a horizon should pass, so that an hour-long experiment is played faster
const AWAITED = 10; // s after which the first fault should come
const BRISK = 100; // the fastest that a session begins with

/**
 * The speed that a session begins with: the first fault is soon there, and the whole is over in a minute.
 * @param {Pick<Experiment, 'horizon' | 'faults'>} spec
 */
export function openingSpeed({horizon, faults}) {
  const first = Math.min(...faults.map(({onset}) => onset).filter((onset) => onset > 0));
  const wanted = Math.min(BRISK, Math.max(horizon / PLAYED_IN, Number.isFinite(first) ? first / AWAITED : 0));
  return SPEEDS.findLast((speed) => speed !== null && speed <= wanted) ?? SPEEDS[0];
}
