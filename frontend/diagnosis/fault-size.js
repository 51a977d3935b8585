// Sizes of faults as the diagnosis spells them.

import {number} from '../common/dom.js';
import {raised} from '../widgets/number-format.js';

/** +0.0200 ± 0.0004: as many decimals as the interval has to say, one power of ten for both. */
export function amount({size, half}, channel) {
  if (!Number.isFinite(size)) return '–';
  const scale = Math.max(Math.abs(size), Number.isFinite(half) ? half : 0, Math.abs(channel?.typical ?? 0) / 1e3);
  const power = scale < 1e-4 || scale >= 1e5 ? Math.floor(Math.log10(scale)) : 0;
  const unit = 10 ** power;
  const width = Number.isFinite(half) && half > 0 ? half / unit : scale / unit / 1e3;
  const places = Math.max(0, Math.min(8, (leading(width) < 2 ? 1 : 0) - Math.floor(Math.log10(width))));
  const spelt = (value) => (value / unit).toFixed(places).replace('-', '−');
  const both = `${size > 0 ? '+' : ''}${spelt(size)}${Number.isFinite(half) ? ` ± ${spelt(half)}` : ''}`;
  return power === 0 ? both : `${both} ·10${raised(power)}`;
}

/** The first digits of a number, from 1 on and below 10. */
const leading = (value) => value / 10 ** Math.floor(Math.log10(value));

/** A size to so many digits, without a power of ten where it can be read at a glance. */
export const small = (value, digits = 2) =>
  Math.abs(value) >= 1e-4 && Math.abs(value) < 1e5 ? String(Number(value.toPrecision(digits))) : number(value, digits);

/**
 * Channels of which not even a typical fault can be told now, from when on anything is judged. One whose fault an alarm names alone is none of
 * them, whatever the last window's input would tell: what has been found is not lost.
 */
export function untold({diagnosis, t, alarms}) {
  if ((diagnosis?.calibration?.from_time ?? Infinity) > t) return [];
  const named = new Set(alarms.flatMap(({over, subjects}) => (over === null && subjects.length === 1 ? subjects : [])));
  return diagnosis.resolution.filter((one) => !one.identifiable && !one.resolvable && !named.has(one.channel));
}

/** What the diagnosis says of one channel: how small a fault can be and still be found. */
export const resolutionOf = (channel, diagnosis) =>
  diagnosis?.resolution?.find((one) => one.channel === channel) ?? null;
