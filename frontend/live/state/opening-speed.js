// The speed that a session begins with.

import {SPEEDS} from '../../widgets/number-format.js';

/** @import {Experiment} from '../types.js' */

const PLAYED_IN = 50; // s in which a horizon should pass, so that an hour-long experiment is played faster
const AWAITED = 10; // s after which the first fault should come
const BRISK = 100; // the fastest that a session begins with, unless its rows lie far apart
const ROWS = 20; // per second, up to which a session of a slow plant begins faster

/**
 * The speed that a session begins with: the first fault is soon there, and the whole is over in a minute.
 * @param {Pick<Experiment, 'horizon' | 'faults'> & {step?: number, evaluate?: number | null}} spec
 */
export function openingSpeed({horizon, faults, step = 0, evaluate = 0}) {
  const first = Math.min(...faults.map(({onset}) => onset).filter((onset) => onset > 0));
  const fastest = Math.max(BRISK, ROWS * Math.max(step, evaluate ?? 0));
  const wanted = Math.min(fastest, Math.max(horizon / PLAYED_IN, Number.isFinite(first) ? first / AWAITED : 0));
  return SPEEDS.findLast((speed) => speed !== null && speed <= wanted) ?? SPEEDS[0];
}
