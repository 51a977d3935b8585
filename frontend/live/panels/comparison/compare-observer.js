// What the comparison says of one observer of one session, this one or the one that it was forked from.

import {finding} from '../../../diagnosis/alarms.js';
import {noise, rmse, settled, unsettled} from './metrics.js';
import {took} from '../../../widgets/controls.js';
import {t} from '../../../i18n/words.js';

/** @import {Alarm, FaultState, Samples} from '../../types.js' */

const MOST = 200_000; // rows after a fault that are looked at
const SETTLED = 0.1; // of the step: as in backend/thetascope/diagnosis/evaluation/metrics.py

/**
 * A session, this one or its parent.
 * @typedef {object} Watched
 * @property {Samples} samples
 * @property {FaultState[]} faults
 * @property {Alarm[]} alarms
 */

/** @typedef {{title: string, words?: string, value?: number}} Figure   words, or a number to be formatted like its column */

/**
 * RMSE, time to settle and noise as {value or words, title}, over from … to; a session that has not come so far has none.
 * @param {Watched} watched
 * @param {string} label
 * @param {[state: string, channel: string | null]} subjects
 * @param {[number, number]} span
 * @returns {Figure[]}
 */
export function figuresOf({samples, faults}, label, [x, theta], [from, to]) {
  const none = {words: '–', title: ''};
  if (to > samples.now + 1.5 * samples.record)
    return theta
      ? [{words: '–', title: t('page.comparison.not-reached')}, none, none]
      : [{words: '–', title: t('page.comparison.not-reached')}];
  const truth = samples.window(`x.${x}`, from, to);
  const mine = samples.window(`${label}.x.${x}`, from, to);
  const error = {value: mine.v.length === truth.v.length ? rmse(mine.v, truth.v) : NaN, title: ''};
  if (!theta) return [error];
  const estimate = samples.window(`${label}.theta.${theta}`, to - (to - from) / 4, to);
  const fault = newest(faults, theta, to);
  return [
    error,
    fault ? settling(samples, faults, label, theta, fault) : none,
    {value: noise(estimate.t, estimate.v), title: ''},
  ];
}

/**
 * @param {FaultState[]} faults
 * @param {string} theta
 * @param {number} t
 */
const newest = (faults, theta, t) => faults.findLast((one) => one.subject === theta && one.onset <= t);

/**
 * How soon the detector named the newest fault.
 * @param {Watched} watched
 * @param {string} theta
 * @param {number} to
 * @returns {Figure}
 */
export function detected({samples, faults, alarms}, theta, to) {
  const fault = newest(faults, theta, Math.min(to, samples.now));
  if (!fault) return {words: '–', title: ''};
  const found = finding(fault, alarms);
  if (found === null) return {words: t('page.comparison.not-yet'), title: ''};
  return found.delay === null
    ? {words: '–', title: t('page.diagnosis.alarm-was-on')}
    : {words: took(found.delay), title: ''};
}

/**
 * @param {Samples} samples
 * @param {FaultState[]} faults
 * @param {string} label
 * @param {string} theta
 * @param {FaultState} fault
 * @returns {Figure}
 */
function settling(samples, faults, label, theta, fault) {
  const none = {words: '–', title: ''};
  if (fault.shape !== 'step') return none;
  const {record} = samples;
  const from = fault.onset;
  const next = Math.min(...faults.flatMap(({onset, end}) => [onset, end ?? Infinity]).filter((event) => event > from)); // disturbs the estimate, too
  const until = Math.min(next - record / 2, samples.now, from + MOST * record);
  const truth = samples.window(`theta.${theta}`, from, until);
  const mine = samples.window(`${label}.theta.${theta}`, from, until);
  if (mine.v.length !== truth.v.length || mine.v.length < 3 || !mine.v.some(Number.isFinite)) return none;
  const within = SETTLED * Math.abs('size' in fault.fault ? fault.fault.size : NaN);
  const time = settled(truth.t, truth.v, mine.v, from, within);
  if (time !== null) return {words: took(time), title: ''};
  return unsettled(truth.t, truth.v, mine.v, within)
    ? {words: t('page.comparison.too-noisy'), title: t('page.comparison.too-noisy.hint')}
    : {words: t('page.comparison.not-yet'), title: t('page.comparison.settle.hint')};
}
