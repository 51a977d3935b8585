// What the small marks on a strip say, where the pointer is on one.

/** @import {App, Row} from '../types.js' */

const NEAR = 6; // px

/**
 * Words for the mark at (x, y) of a strip's plot, of which `timeAt(x)` is the time; '' where there is none.
 * @param {Row} row
 * @param {number} x
 * @param {number} y
 * @param {(x: number) => number} timeAt
 * @param {App} app
 */
export function markWords({strip, place}, x, y, timeAt, {state, text, samples}) {
  const [from, t, to] = [timeAt(x - NEAR), timeAt(x), timeAt(x + NEAR)];
  /** @param {string} name @param {...number} times */
  const said = (name, ...times) =>
    `${times.map((one) => one.toFixed(state.record >= 1 ? 0 : 1)).join('–')} s: ${text.marks[name]}`;
  const gone = strip.leaving?.find(
    ({from: a, to: b, up}) =>
      (a + b) / 2 > timeAt(x - 3 * NEAR) &&
      (a + b) / 2 < timeAt(x + 3 * NEAR) &&
      (up ? y < 2 * NEAR : y > place.height - 2 * NEAR),
  );
  const named =
    strip.kind !== 'theta' && strip.kind !== 'residual'
      ? []
      : state.alarms.filter((alarm) =>
          strip.kind === 'theta'
            ? alarm.subjects.includes(strip.subject)
            : !alarm.explained && alarm.subject === strip.subject,
        );
  for (const alarm of named) {
    if (y < 2 * NEAR && alarm.t > from && alarm.t < to)
      return said(alarm.subject === strip.subject ? 'alarm' : 'second', alarm.t);
    if (y > place.height - 2 * NEAR && alarm.from < to && alarm.to > from) return said('onset', alarm.from, alarm.to);
    if (y < NEAR && t > alarm.t && t < (alarm.over ?? samples.now))
      return said('stands', alarm.t, alarm.over ?? samples.now);
  }
  return gone ? text.marks.leaves : '';
}
