// Sizes of faults as the diagnosis spells them.

import {number} from '../common/dom.js';
import {raised} from '../widgets/number-format.js';

/** @import {Alarm, Diagnosis} from '../live/types.js' */

/**
 * A size with its interval: +0.0200 ± 0.0004, with as many decimals as the interval justifies, and one power of ten
 * for both.
 * @param {{size: number | null, half: number | null}} alarm
 * @param {{typical?: number | null}} [channel]
 */
export function amount({size, half: given}, channel) {
  if (size === null || !Number.isFinite(size)) return '–';
  const half = given ?? NaN;
  const scale = Math.max(Math.abs(size), Number.isFinite(half) ? half : 0, Math.abs(channel?.typical ?? 0) / 1e3);
  const power = scale < 1e-4 || scale >= 1e5 ? Math.floor(Math.log10(scale)) : 0;
  const unit = 10 ** power;
  const width = Number.isFinite(half) && half > 0 ? half / unit : scale / unit / 1e3;
  const places = Math.max(0, Math.min(8, (leading(width) < 2 ? 1 : 0) - Math.floor(Math.log10(width))));
  /** @param {number} value */
  const written = (value) => (value / unit).toFixed(places).replace('-', '−');
  const both = `${size > 0 ? '+' : ''}${written(size)}${Number.isFinite(half) ? ` ± ${written(half)}` : ''}`;
  return power === 0 ? both : `${both} ·10${raised(power)}`;
}

/**
 * The mantissa of a number, at least 1 and below 10.
 * @param {number} value
 */
const leading = (value) => value / 10 ** Math.floor(Math.log10(value));

/**
 * A size to a number of digits, without a power of ten where it is short.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export const small = (value, digits = 2) =>
  value && Math.abs(value) >= 1e-4 && Math.abs(value) < 1e5
    ? String(Number(value.toPrecision(digits)))
    : number(value, digits);

/**
 * Channels of which not even a typical fault can be distinguished now; none before the diagnosis judges anything. A
 * channel that an alarm names alone is left out, whatever the input of the last window shows.
 * @param {{diagnosis: Diagnosis | null, t: number, alarms: Pick<Alarm, 'over' | 'subjects'>[]}} state
 * @returns {Diagnosis['resolution']}
 */
export function unresolved({diagnosis, t, alarms}) {
  if (!diagnosis || (diagnosis.calibration?.from_time ?? Infinity) > t) return [];
  const named = new Set(alarms.flatMap(({over, subjects}) => (over === null && subjects.length === 1 ? subjects : [])));
  return diagnosis.resolution.filter((one) => !one.identifiable && !one.resolvable && !named.has(one.channel));
}

/**
 * How small a fault of a channel can be and still be found.
 * @param {string} channel
 * @param {Diagnosis | null} diagnosis
 */
export const resolutionOf = (channel, diagnosis) =>
  diagnosis?.resolution?.find((one) => one.channel === channel) ?? null;
