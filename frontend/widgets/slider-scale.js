// Between a slider's position (0 … 1000) and a value: linear, or logarithmic with or without a zero at the left end.

export const ENDS = 1000;
const ZERO = 20; // positions at the left end that mean 0 on a logarithmic scale with a zero

/** @typedef {{min: number, max: number, kind: 'linear'|'log', zero: boolean}} Scale */

/**
 *
 * @param {number} min
 * @param {number} max
 * @returns {Scale}
 */
export const linear = (min, max) => ({min, max, kind: 'linear', zero: false});

/**
 *
 * @param {number} min
 * @param {number} max
 * @param {boolean} [zero]
 * @returns {Scale}
 */
export const logarithmic = (min, max, zero = false) => ({min, max, kind: 'log', zero});

/**
 * The position of a value; beyond the ends: the end.
 * @param {Scale} scale
 * @param {number} value
 */
export function position(scale, value) {
  if (scale.kind === 'linear') return clamp(((value - scale.min) / (scale.max - scale.min)) * ENDS);
  if (!(value > 0)) return 0;
  const share = Math.log(value / scale.min) / Math.log(scale.max / scale.min);
  return scale.zero ? clamp(ZERO + share * (ENDS - ZERO)) : clamp(share * ENDS);
}

/**
 * The value at a position, rounded to the resolution of a slider.
 * @param {Scale} scale
 * @param {number} place
 */
export function value(scale, place) {
  if (scale.kind === 'linear') {
    const size = Math.max(Math.abs(scale.min), Math.abs(scale.max));
    const unit = 10 ** (Math.floor(Math.log10(Math.min(size, scale.max - scale.min) || 1)) - 2);
    const exact = scale.min + (place / ENDS) * (scale.max - scale.min);
    return Number((Math.round(exact / unit) * unit).toPrecision(12));
  }
  if (scale.zero && place < ZERO) return 0;
  const share = scale.zero ? (place - ZERO) / (ENDS - ZERO) : place / ENDS;
  return Number((scale.min * (scale.max / scale.min) ** share).toPrecision(3));
}

/**
 * The significant digits that distinguish the values of a scale: three, more where it is narrow.
 * @param {Scale} scale
 */
export function digitsOf({min, max, kind}) {
  if (kind === 'log' || !(max > min)) return 3;
  return 3 + Math.max(0, Math.floor(Math.log10(Math.max(Math.abs(min), Math.abs(max)) / (max - min))));
}

/**
 * The scale of a gain around the value it begins with, within its bounds.
 * @param {{low: number | null, high: number | null, positive?: boolean}} bounds   null: no bound
 * @param {number} begin
 */
export function gainScale({low: least, high: most, positive = false}, begin) {
  const [low, high] = [least ?? -Infinity, most ?? Infinity];
  const size = Math.abs(begin) || 1;
  if (high - low <= 10) return linear(low, high);
  if (low < 0) return linear(Math.max(low, -4 * size), Math.min(high, 4 * size));
  const zero = low === 0 && !positive;
  return logarithmic(Math.max(low, size / 30), Math.min(high, size * 30), zero);
}

/**
 * 1, 2 or 5 times a power of ten, the nearest.
 * @param {number} number
 */
export function nice(number) {
  if (!Number.isFinite(number) || number === 0) return 0;
  const power = 10 ** Math.floor(Math.log10(Math.abs(number)));
  const lead = Math.abs(number) / power;
  return Number((Math.sign(number) * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power).toPrecision(1));
}

/** @param {number} place */
const clamp = (place) => Math.round(Math.min(ENDS, Math.max(0, place)));
