// What the alarms amount to: one finding an alarm or an unfound fault, and the sentence that says it. Pure: from the state, no document.

import {finding, names} from './alarms.js';
import {resolutionOf} from './fault-size.js';

/**
 * @typedef {object} Finding
 * @property {'found'|'blamed'|'false'|'over'|'unseen'|'past'} verdict   an alarm on a fault that acts; on another than the one that acts; where none
 *                                 acts; on one that has ended; a fault without an alarm; an alarm that is over
 * @property {string} subject
 * @property {string[]} subjects   chips: the channel and its alternatives, or the one subject
 * @property {boolean} onChannel
 * @property {import('./alarms.js').Alarm | null} alarm
 * @property {object | null} fault    the one without an alarm
 * @property {number | null} delay   from the fault to the alarm, where this alarm found it
 * @property {number | null} again   when the fault that acts began, where the alarm of one before it was on already
 */

const MOST_PAST = 20;

/** Findings for the present: alarms that are on, faults that were not found, alarms that are over. @returns {Finding[]} */
export function findings({faults, alarms}) {
  const active = faults.filter((fault) => fault.active);
  const on = alarms.filter((alarm) => alarm.over === null);
  const unseen = active.filter(
    (fault) => !alarms.some((alarm) => names(alarm, fault) && (alarm.over === null || outlasted(alarm, fault))),
  );
  const past = alarms
    .filter((alarm) => alarm.over !== null)
    .slice(-MOST_PAST)
    .reverse();
  const once = unseen.filter((fault, place) => unseen.findIndex((one) => one.subject === fault.subject) === place);
  return [
    ...on.map((alarm) => found(alarm, judged(alarm, faults, active), faults, alarms)),
    ...once.map((fault) => ({
      verdict: 'unseen',
      subject: fault.subject,
      subjects: [fault.subject],
      onChannel: fault.onChannel,
      alarm: null,
      fault,
      delay: null,
    })),
    ...past.map((alarm) => found(alarm, 'past', faults, alarms)),
  ];
}

/** Whether an alarm was on until its fault had ended: it may be told as over a moment before the rows in which the fault ends are shown. */
const outlasted = (alarm, {end}) => end !== null && alarm.t <= end && alarm.over >= end;

function found(alarm, verdict, faults, alarms) {
  const mine = faults
    .filter((one) => one.onset <= alarm.t)
    .map((fault) => finding(fault, alarms))
    .filter((one) => one?.alarm === alarm && one.delay !== null);
  const made = {
    verdict,
    subject: alarm.subject,
    subjects: alarm.explained ? alarm.subjects : [alarm.subject],
    onChannel: alarm.explained,
    alarm,
    fault: null,
    delay: mine.length ? mine.at(-1).delay : null,
    again: null,
  };
  if (verdict !== 'found') return made;
  // what was found may be over, and another have come while its alarm was still on: that one was not found in so much time
  const now = faults
    .filter((fault) => fault.active && names(alarm, fault))
    .map((fault) => ({fault, by: finding(fault, alarms)}))
    .filter(({by}) => by?.alarm === alarm);
  if (now.length === 0 || now.some(({by}) => by.delay !== null)) return made;
  return {...made, delay: null, again: now.at(-1).fault.onset};
}

/** An alarm that is on, held against the truth. */
function judged(alarm, faults, active) {
  // an alarm may be told a moment before the rows in which its fault begins are shown
  if (
    active.some((fault) => names(alarm, fault)) ||
    faults.some((fault) => names(alarm, fault) && fault.onset <= alarm.t && fault.ended === false)
  )
    return 'found';
  const then = faults.filter((fault) => fault.onset <= alarm.t && (fault.end === null || fault.end >= alarm.from));
  if (then.some((fault) => fault.active)) return 'blamed';
  return then.length ? 'over' : 'false';
}

/**
 * The sentence: {key, …} of app.text.sentences.
 * @param {Finding[]} all
 * @param {{t: number, diagnosis: object | null, broken?: number | null, observers?: object[]}} state
 */
export function sentence(all, {t, diagnosis, broken = null, observers = []}) {
  if (broken !== null) return {key: 'broken', at: broken};
  const of = (verdict) => all.filter((one) => one.verdict === verdict);
  const [good, unseen] = [of('found'), of('unseen')];
  const [blamed] = of('blamed');
  const [wrong] = of('false');
  if (diagnosis?.note) return {key: 'noDiagnosis', note: diagnosis.note};
  const strange = all.find((one) => one.alarm?.over === null && !one.onChannel && one.verdict !== 'over');
  if (strange) return {key: 'unexplained', subject: strange.subject};
  const real = unseen[0] ?? good[0];
  if (blamed && real) return {key: 'blamed', subject: blamed.subject, other: real.subject, onChannel: real.onChannel};
  if (wrong) return {key: 'falseAlarm', subject: wrong.subject};
  const either = good.findLast((one) => one.subjects.length > 1);
  if (either) return {key: 'either', subjects: either.subjects};
  if (unseen.length) {
    const first = unseen.find((one) => one.onChannel) ?? unseen[0];
    const known = first.onChannel && resolutionOf(first.subject, diagnosis);
    const hidden = known && !known.identifiable && !known.resolvable;
    return {
      key: hidden ? 'hidden' : first.onChannel ? 'looking' : 'measurement',
      subject: first.subject,
      count: good.length,
      open: unseen.length,
    };
  }
  if (good.length === 1) {
    const [{subject, alarm, delay, again}] = good;
    return {key: delay !== null ? 'oneFound' : again ? 'oneAgain' : 'one', subject, alarm, took: delay, again};
  }
  if (good.length) {
    const last = good.filter((one) => one.delay !== null).at(-1);
    return last
      ? {key: 'allNamed', count: good.length, subject: last.subject, took: last.delay}
      : {key: 'several', count: good.length};
  }
  if (of('over').length) return {key: 'ending'};
  const lost = observers.filter((one) => one.diverged);
  if (lost.length)
    return {
      key: 'lost',
      count: lost.length,
      label: lost.at(-1).label,
      at: lost.at(-1).diverged.t,
      all: lost.length === observers.length,
      only: observers.length === 1,
    };
  if (all.length) return {key: 'quietAgain'};
  const from = diagnosis?.calibration?.from_time;
  return from > t ? {key: 'early', from} : {key: 'quiet'};
}
