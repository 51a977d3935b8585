// The detector's alarms in the page's form. Pure.

/** @import * as service from '../types/service.js' */

/**
 * @typedef {object} Alarm
 * @property {string} id             stays while the alarm is revised
 * @property {boolean} explained     a fault of the model explains it
 * @property {string} subject        the channel that explains the data best, or the output that nothing explains
 * @property {string[]} subjects     that channel, and those that explain the data equally well; empty if none does
 * @property {number} t              time in s at which it was raised
 * @property {number | null} over    time in s at which it was cleared
 * @property {number} onset          time in s at which the fault began, as estimated, and the interval of that
 * @property {number} from
 * @property {number} to
 * @property {number | null} size    in the channel's unit, ± half
 * @property {number | null} half
 */

/**
 * An alarm of the server (shared/thetascope_schemas/experiment/diagnosis.py) in the page's form.
 * @param {service.Alarm} alarm
 * @returns {Alarm}
 */
export function alarmFrom({id, kind, channel, output, alternatives, t, cleared, onset, ...rest}) {
  const explained = kind === 'fault';
  const {onset_from: from, onset_to: to, size, size_from: low, size_to: high} = rest;
  return {
    id,
    explained,
    subject: explained ? channel : output.replace(/^y\./, ''),
    subjects: explained ? [channel, ...alternatives] : [],
    t,
    over: cleared,
    onset,
    from,
    to,
    size,
    half: size === null || low === null || high === null ? null : (high - low) / 2,
  };
}
