// What a lesson shows: truth and diagnosis can be hidden, and the time that a step has yet to run is hatched.

import {t} from '../../i18n/words.js';

/** @import {State} from '../types.js' */

/**
 * The faults and alarms to draw.
 * @param {Pick<State, 'faults' | 'alarms' | 'lesson'>} state
 * @returns {Pick<State, 'faults' | 'alarms'>}
 */
export const visible = ({faults, alarms, lesson}) => ({
  faults: lesson && !lesson.truth ? [] : faults,
  alarms: lesson && !lesson.diagnosis ? [] : alarms,
});

/**
 * The time until which a step has yet to run, and the words to write there.
 * @param {Pick<State, 'lesson'>} state
 */
export const pending = ({lesson}) =>
  typeof lesson?.until === 'number'
    ? {until: lesson.until, words: lesson.sketch ? '' : t('page.lesson.your-turn')} // there is a curve already
    : null;
