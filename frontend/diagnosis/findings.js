// Findings: one for each alarm, and one for each fault that no alarm names. The server judges
// (diagnosis/evaluation/verdicts.py); this only puts its verdicts in order. Pure.

import {alarmFrom} from './alarms.js';

/** @import {Alarm} from './alarms.js' */
/** @import {FaultState} from '../live/types.js' */
/** @import * as service from '../types/service.js' */

/**
 * @typedef {object} Finding
 * @property {'found'|'misattributed'|'false'|'over'|'undetected'|'past'} verdict
 *   of an alarm: its fault is active; another fault is active; none is
 *                                 has acted; on a fault that has ended; a fault without an alarm; an alarm that is
 * cleared
 * @property {string} subject
 * @property {string[]} subjects   chips: the channel and its alternatives, or the one subject
 * @property {boolean} onChannel
 * @property {Alarm | null} alarm
 * @property {FaultState | null} fault    the one without an alarm
 * @property {number | null} delay   from the fault to the alarm, where this alarm found it
 * @property {boolean} [unjudged]   of a fault without an alarm: the detector has not judged that far yet
 * @property {number | null} again   when the fault that acts began, where the alarm of one before it was on already
 */

const MOST_PAST = 20;

/** @type {Record<service.AlarmOutcome['state'], Finding['verdict']>} */
const VERDICTS = {
  acting: 'found',
  covering: 'found',
  'other-fault': 'misattributed',
  'no-fault': 'false',
  'fault-over': 'over',
  cleared: 'past',
};

/**
 * The facts of the server for the page's state: faults and alarms in its form, noise, and when the plant diverged.
 * @param {service.Facts} facts
 */
export const stateOf = (facts) => ({
  facts,
  faults: facts.faults.map((fault) => ({...fault, onChannel: fault.kind === 'channel'})),
  alarms: facts.alarms.map(alarmFrom),
  noise: facts.noise,
  broken: facts.broken,
});

/**
 * Findings at the time of the facts: alarms that are on, faults that no alarm names, alarms that are cleared, the
 * newest first.
 * @param {{facts: service.Facts, faults: FaultState[], alarms: Alarm[]}} state
 * @returns {Finding[]}
 */
export function findings({facts, faults, alarms}) {
  const verdicts = new Map(facts.alarm_verdicts.map((verdict) => [verdict.id, verdict]));
  const judged = alarms.flatMap((alarm) => {
    const verdict = verdicts.get(alarm.id);
    return verdict ? [ofAlarm(alarm, verdict)] : [];
  });
  const undetected = facts.undetected
    .flatMap((id) => faults.filter((fault) => fault.id === id))
    .map((fault) => ({
      ...ofFault(fault),
      unjudged: typeof facts.judged === 'number' && fault.onset >= facts.judged,
    }));
  const past = judged.filter((one) => one.verdict === 'past');
  return [...judged.filter((one) => one.verdict !== 'past'), ...undetected, ...past.slice(-MOST_PAST).reverse()];
}

/** @param {Alarm} alarm @param {service.AlarmOutcome} verdict @returns {Finding} */
const ofAlarm = (alarm, {state, delay, covers_since: again}) => ({
  verdict: VERDICTS[state],
  subject: alarm.subject,
  subjects: alarm.explained ? alarm.subjects : [alarm.subject],
  onChannel: alarm.explained,
  alarm,
  fault: null,
  delay: state === 'covering' ? null : delay,
  again: state === 'covering' ? again : null,
});

/** @param {FaultState} fault @returns {Finding} */
const ofFault = (fault) => ({
  verdict: 'undetected',
  subject: fault.subject,
  subjects: [fault.subject],
  onChannel: fault.onChannel,
  alarm: null,
  fault,
  delay: null,
  again: null,
});
