// What the alarms amount to: one finding a fault, and the sentence that says it. Pure: from the state, no document.

/**
 * @typedef {object} Finding
 * @property {string} subject
 * @property {boolean} onChannel
 * @property {'named'|'unseen'|'false'|'over'} verdict   found; acts but not named; named but nothing acts; found and over
 * @property {number | null} began       when the fault began (the truth)
 * @property {number | null} found       when the first observer named it
 * @property {object | null} observer    ObserverState that named it first
 */

/** Faults that act from the next row on: while time stands still, what was injected or cleared just now counts already. */
export function acting({faults, t, record}) {
  const next = t + record * 1.001;
  return faults.filter((fault) => fault.onset <= next && (fault.end === null || fault.end > next));
}

/**
 * Findings for the present: active faults first, in the order in which they began; then alarms without a fault.
 * @returns {Finding[]}
 */
export function findings(state) {
  const {faults, alarms, observers} = state;
  const active = new Map();
  for (const fault of acting(state)) if (!active.has(fault.subject)) active.set(fault.subject, fault);
  const standing = alarms.filter((alarm) => alarm.over === null && observers.some((one) => one.label === alarm.observer));
  const watching = (alarm) => observers.find((one) => one.label === alarm.observer) ?? null;
  const made = [...active.values()].map((fault) => {
    const mine = alarms.filter((alarm) => alarm.subject === fault.subject && alarm.t >= fault.onset - 1e-9 && watching(alarm));
    const held = standing.find((alarm) => alarm.subject === fault.subject);
    const first = mine[0] ?? held;
    return {subject: fault.subject, onChannel: fault.onChannel, verdict: first ? 'named' : 'unseen', began: fault.onset, found: first?.t ?? null, observer: first ? watching(held ?? first) : null};
  });
  const others = new Map();
  for (const alarm of standing) if (!active.has(alarm.subject) && !others.has(alarm.subject)) others.set(alarm.subject, alarm);
  return [...made, ...[...others.values()].map((alarm) => ({subject: alarm.subject, onChannel: true, verdict: acted(faults, alarm) ? 'over' : 'false',
    began: null, found: alarm.t, observer: watching(alarm)}))];
}

/** Whether a fault that has ended explains an alarm that still stands. */
const acted = (faults, alarm) => faults.some((fault) => fault.subject === alarm.subject && !fault.active && fault.onset <= alarm.t + 1e-9);

/**
 * The sentence: {key, values} of app.text.sentences.
 * @param {Finding[]} found
 */
export function sentence(found, {observers, faults, estimating}) {
  const named = found.filter((one) => one.verdict === 'named');
  const unseen = found.filter((one) => one.verdict === 'unseen');
  const wrong = found.filter((one) => one.verdict === 'false');
  if (observers.length === 0) return {key: 'nobody'};
  if (observers.every((one) => one.diverged)) return {key: 'allDiverged'};
  if (found.length === 0) return {key: faults.length && faults.some((one) => !one.active && one.end !== null) ? 'quietAgain' : 'quiet'};
  if (!estimating) return {key: 'cannotName', count: unseen.length};
  if (unseen.length === 0 && wrong.length === 0 && named.length) {
    const last = named.reduce((a, b) => (b.began > a.began ? b : a));
    return {key: 'allNamed', count: named.length, subject: last.subject, took: Math.max(0, last.found - last.began)};
  }
  if (wrong.length && unseen.length) return {key: 'blamed', subject: wrong[0].subject, other: unseen[0].subject, onChannel: unseen[0].onChannel};
  if (wrong.length) return {key: 'falseAlarm', subject: wrong[0].subject, count: named.length};
  if (unseen.length === 0) return {key: 'quietAgain'};
  const first = unseen.find((one) => one.onChannel) ?? unseen[0];
  return {key: first.onChannel ? 'looking' : 'measurement', subject: first.subject, count: named.length, open: unseen.length};
}
