// The comparison's figures of one session, as the server gives them (GET /api/sessions/{id}/comparison), in the words
// of the table. Pure.

import {took} from '../../../widgets/controls.js';
import {t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */

/**
 * A cell: words, or a number that is written like the others of its column. With both, the number orders the rows.
 * @typedef {{words?: string, value?: number, title: string}} Figure
 */

/** @type {Figure} */
const NONE = {words: '–', title: ''};

/**
 * RMSE, time to settle and noise of an observer, up to time `to`; a session that has not come so far has none.
 * @param {service.WindowComparison} answer
 * @param {string} label
 * @param {number} to
 * @param {number} record   s between rows
 * @returns {Figure[]}
 */
export function figuresOf({t: now, channel, observers}, label, to, record) {
  const mine = observers.find((one) => one.label === label);
  const reached = to <= now + 1.5 * record;
  const error = !reached ? {words: '–', title: t('page.comparison.not-reached')} : number(mine?.rmse);
  if (channel === null) return [error];
  return reached && mine ? [error, settling(mine), number(mine.noise)] : [error, NONE, NONE];
}

/** @param {number | null | undefined} value @returns {Figure} */
export const number = (value) => ({value: value ?? NaN, title: ''});

/**
 * How soon an estimate settled.
 * @param {Pick<service.ObserverInWindow, 'settled' | 'outcome'>} figures
 * @returns {Figure}
 */
export function settling({settled, outcome}) {
  if (outcome === 'settled' && settled !== null) return {words: took(settled), value: settled, title: ''};
  if (outcome === 'too-noisy')
    return {words: t('page.comparison.too-noisy'), title: t('page.comparison.too-noisy.hint')};
  return outcome === 'not-yet' ? {words: t('page.comparison.not-yet'), title: t('page.comparison.settle.hint')} : NONE;
}

/**
 * How soon the detector found the newest fault.
 * @param {service.WindowComparison} answer
 * @returns {Figure}
 */
export function detected({fault}) {
  if (!fault || fault.outcome === null) return NONE;
  if (fault.outcome === 'found' && fault.delay !== null) return {words: took(fault.delay), title: ''};
  return fault.outcome === 'covered'
    ? {words: '–', title: t('page.diagnosis.alarm-was-on')}
    : {words: t('page.comparison.not-yet'), title: ''};
}
