// The detector's alarms: from the log, with what the diagnosis has learnt about them since. Pure.

/**
 * @typedef {object} Alarm
 * @property {boolean} explained     a fault of the model explains it
 * @property {string} subject        the channel that explains the data best, or the output that nothing explains
 * @property {string[]} subjects     that channel, and those that explain the data as well; none where nothing does
 * @property {number} t              when it was raised
 * @property {number | null} over    when it was over
 * @property {number} onset          when the fault began, as estimated, and the interval of that
 * @property {number} from
 * @property {number} to
 * @property {number | null} size    in the channel's unit, ± half
 * @property {number | null} half
 */

const SAME = 1e-6; // s

/**
 * Alarms of a log, each from its event until its alarm-over, oldest first.
 * @param {object[]} log
 * @param {object | null} diagnosis   the newest message: sizes and alternatives are from there where it knows the alarm, what stands and what is over is not
 *                                    (it is a little ahead of what is shown)
 * @returns {Alarm[]}
 */
export function alarmsOf(log, diagnosis = null) {
  const alarms = [];
  for (const event of log) {
    if (event.kind === 'alarm')
      alarms.push({...alarmFrom(known(event.value, diagnosis?.alarms ?? [])), t: event.t, over: null});
    else if (event.kind === 'alarm-over') {
      const open = alarms.filter((alarm) => alarm.over === null && alarm.subject === event.subject);
      const mine = open.find((alarm) => Math.abs(alarm.t - event.value.t) < SAME) ?? open[0];
      if (mine) mine.over = event.t;
    }
  }
  return alarms;
}

const known = (value, alarms) =>
  alarms.find(
    (one) =>
      Math.abs(one.t - value.t) < SAME &&
      one.kind === value.kind &&
      one.channel === value.channel &&
      one.output === value.output,
  ) ?? value;

/** An alarm as the server tells it (shared/thetascope_schemas/experiment/diagnosis.py) in the page's form. @returns {Alarm} */
export function alarmFrom({
  kind,
  channel,
  output,
  alternatives,
  t,
  cleared,
  onset,
  onset_from: from,
  onset_to: to,
  size,
  size_from: low,
  size_to: high,
}) {
  const explained = kind === 'fault';
  return {
    explained,
    subject: explained ? channel : output.replace(/^y\./, ''),
    subjects: explained ? [channel, ...alternatives] : [],
    t,
    over: cleared,
    onset,
    from,
    to,
    size,
    half: size === null ? null : (high - low) / 2,
  };
}

/** Whether an event says that the plant itself broke down: one of no subject. */
export const plantBroke = ({kind, subject}) => kind === 'diverged' && subject === '';

/** Whether an alarm names what a fault disturbs, as its first guess or as one of the alternatives. */
export const names = (alarm, fault) =>
  fault.onChannel ? alarm.subjects.includes(fault.subject) : !alarm.explained && alarm.subject === fault.subject;

/**
 * How a fault was found: by the first alarm raised after it began that names it; `delay` null where such an alarm was on already; null where there is none.
 * @returns {{alarm: Alarm, delay: number | null} | null}
 */
export function finding(fault, alarms) {
  const mine = alarms.filter((alarm) => names(alarm, fault));
  const first = mine.find(
    (alarm) => alarm.t >= fault.onset - SAME && (fault.end === null || Math.min(alarm.onset, alarm.t) <= fault.end),
  );
  if (first) return {alarm: first, delay: Math.max(0, first.t - fault.onset)};
  const held = mine.find((alarm) => alarm.t < fault.onset && (alarm.over === null || alarm.over > fault.onset));
  return held ? {alarm: held, delay: null} : null;
}
