// The meaning of the small mark on a strip under the pointer.

/** @import {App, Row} from '../types.js' */

import {t} from '../../i18n/words.js';
import {visible} from '../state/visible.js';

const NEAR = 6; // px

/**
 * Words for the mark at (x, y) of a strip's plot, of which `timeAt(x)` is the time; '' without a mark.
 * @param {Row} row
 * @param {number} x
 * @param {number} y
 * @param {(x: number) => number} timeAt
 * @param {App} app
 */
export function markWords({strip, place}, x, y, timeAt, {state, samples}) {
  const [from, at, to] = [timeAt(x - NEAR), timeAt(x), timeAt(x + NEAR)];
  /** @param {number} time */
  const seconds = (time) => time.toFixed(state.record >= 1 ? 0 : 1);
  /** @param {string} mark @param {number} start @param {number | null} end */
  const timed = (mark, start, end = null) =>
    end === null
      ? t('page.marks.at', {t: seconds(start), mark})
      : t('page.marks.during', {from: seconds(start), to: seconds(end), mark});
  const gone = strip.leaving?.find(
    ({from: a, to: b, up}) =>
      (a + b) / 2 > timeAt(x - 3 * NEAR) &&
      (a + b) / 2 < timeAt(x + 3 * NEAR) &&
      (up ? y < 2 * NEAR : y > place.height - 2 * NEAR),
  );
  const named =
    strip.kind !== 'theta' && strip.kind !== 'residual'
      ? []
      : visible(state).alarms.filter((alarm) =>
          strip.kind === 'theta'
            ? alarm.subjects.includes(strip.subject)
            : !alarm.explained && alarm.subject === strip.subject,
        );
  for (const alarm of named) {
    if (y < 2 * NEAR && alarm.t > from && alarm.t < to)
      return timed(alarm.subject === strip.subject ? t('page.marks.alarm') : t('page.marks.second'), alarm.t);
    if (y > place.height - 2 * NEAR && alarm.from < to && alarm.to > from)
      return timed(t('page.marks.onset'), alarm.from, alarm.to);
    if (y < NEAR && at > alarm.t && at < (alarm.over ?? samples.now))
      return timed(t('page.marks.alarm-on'), alarm.t, alarm.over ?? samples.now);
  }
  return gone ? t('page.marks.leaves') : '';
}
