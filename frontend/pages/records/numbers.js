// Numbers with their intervals, and lengths of time, as the page of records writes them. Pure.

import {number} from '../../common/dom.js';

const MINUTE = 60;
const HOUR = 3600;
const DAY = 86400;

/**
 * A number with its interval, with as many decimals as the interval justifies: 1.001 ± 0.019; where the interval is
 * lopsided its ends: 1.00 (0.40 … 3.20).
 * @param {{value: number, low: number, high: number}} interval
 */
export function withInterval({value, low, high}) {
  const half = (high - low) / 2;
  if (!(half > 0) || !Number.isFinite(half)) return number(value);
  const power = Math.floor(Math.log10(half));
  const lead = half / 10 ** power;
  const lopsided = Math.abs((high + low) / 2 - value) > 0.2 * half;
  const places = Math.min(9, Math.max(0, (lead < 2 ? 1 : 0) - power + (lopsided ? 1 : 0)));
  const size = Math.max(Math.abs(value), half);
  /** @param {number} one */
  const written = (one) =>
    size < 1e-3 || size >= 1e6
      ? number(one, 3)
      : one
          .toFixed(places)
          .replace(/^-(?=0(\.0*)?$)/, '')
          .replace('-', '−');
  return lopsided
    ? `${written(value)} (${written(low)} … ${written(high)})`
    : `${written(value)} ± ${size < 1e-3 || size >= 1e6 ? number(half, 2) : half.toFixed(places)}`;
}

/**
 * A length of time in few characters: 599 s, 45 min, 2.5 h, 3 d.
 * @param {number} seconds
 */
export function span(seconds) {
  const [unit, name] =
    seconds < 10 * MINUTE
      ? [1, 's']
      : seconds < 2 * HOUR
        ? [MINUTE, 'min']
        : seconds < 3 * DAY
          ? [HOUR, 'h']
          : [DAY, 'd'];
  return `${number(seconds / unit, 3)}\u202f${name}`;
}

/**
 * A share as a percentage: 0.977 → 97.7 %.
 * @param {number | null} share
 */
export const percent = (share) =>
  share === null || !Number.isFinite(share) ? '–' : `${(100 * share).toFixed(1).replace('-', '−')}\u202f%`;

/** Standard deviations to each side of a band: 95 %. */
export const WIDE = 2;
