// What of the truth and the diagnosis is visible: in a lesson both can be hidden.

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
