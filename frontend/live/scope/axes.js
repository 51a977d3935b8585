// Axes that change seldom: marks at round numbers, and ranges that widen when they must, shrink only after a while, and
// glide.

/** @import {Bins, Samples} from '../types.js' */

const GLIDE = 380; // ms
const PATIENCE = 3000; // ms for which a range must be too wide before it shrinks
const MUCH = 0.7; // how little of it must be used
const ROOM = 0.12; // of the range, added where it widens
const EDGE = 0.015; // of it, which nothing may enter for long
const still = globalThis.matchMedia?.('(prefers-reduced-motion: reduce)'); // a browser's

/**
 * The round step of which about `count` fit between two values: 1, 2 or 5 times a power of ten.
 * @param {number} span
 * @param {number} count
 */
export function niceStep(span, count) {
  if (!(span > 0) || !Number.isFinite(span)) return 1;
  const raw = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(raw));
  const lead = raw / power;
  return power * (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10);
}

/**
 * Multiples of a step between two values.
 * @param {number} low
 * @param {number} high
 * @param {number} step
 */
export function marks(low, high, step) {
  const multiples = [];
  for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; i += 1)
    multiples.push(i === 0 ? 0 : Number((i * step).toPrecision(12)));
  return multiples;
}

/**
 * A range with a little room about two values, its ends at round numbers, and the step between these.
 * @param {number} low
 * @param {number} high
 * @returns {[[number, number], number]}
 */
function rounded(low, high) {
  const span = high - low || Math.abs(high) * 0.1 || 1;
  const step = niceStep(span, 8);
  return [[Math.floor((low - 0.04 * span) / step) * step, Math.ceil((high + 0.04 * span) / step) * step], step];
}

/** The range of an axis. `aim` sets the values that should be visible, `move` brings the range there. */
export class Range {
  constructor() {
    this.low = NaN;
    this.high = NaN;
    /** @type {[number, number] | null} */
    this.target = null;
    /** @type {{at: number, low: number, high: number} | null} */
    this.start = null;
    this.wide = 0; // since when it has been too wide
  }

  /**
   * Make the values between low and high visible; `atOnce` where the old range means nothing (another plant, another
   * window).
   * @param {number} low
   * @param {number} high
   * @param {number} now
   * @param {boolean} [atOnce]
   */
  aim(low, high, now, atOnce = false) {
    if (!(high >= low)) return;
    const [wanted, step] = rounded(low, high);
    if (this.target === null || atOnce) {
      this.jump(wanted);
      return;
    }
    const [from, to] = this.target;
    const ahead = ROOM * (wanted[1] - wanted[0]); // a value that has outgrown the axis usually goes on growing
    const edge = EDGE * (to - from);
    if (low < from + edge || high > to - edge) {
      this.glide(
        [
          low < from + edge ? wanted[0] - Math.ceil(ahead / step) * step : from,
          high > to - edge ? wanted[1] + Math.ceil(ahead / step) * step : to,
        ],
        now,
      );
    }
    const [bottom, top] = this.target;
    const used = (wanted[1] - wanted[0]) / (top - bottom);
    if (used > MUCH) this.wide = 0;
    else if (this.wide === 0) this.wide = now;
    else if (now - this.wide > PATIENCE) this.glide(wanted, now);
  }

  /** @param {[number, number]} wanted */
  jump(wanted) {
    this.target = wanted;
    [this.low, this.high] = wanted;
    this.start = null;
    this.wide = 0;
  }

  /**
   * Show just these values now, however long the range has been too wide.
   * @param {number} low
   * @param {number} high
   * @param {number} now
   */
  show(low, high, now) {
    if (!(high >= low)) return;
    if (this.target === null) this.jump(rounded(low, high)[0]);
    else this.glide(rounded(low, high)[0], now);
  }

  /** @param {[number, number]} wanted @param {number} now */
  glide(wanted, now) {
    if (this.target === null) return;
    if (wanted[0] === this.target[0] && wanted[1] === this.target[1]) return;
    if (still?.matches) {
      this.jump(wanted);
      return;
    }
    this.target = wanted;
    this.start = {at: now, low: this.low, high: this.high};
    this.wide = 0;
  }

  /**
   * Bring the range to where it is at time now; whether it is still moving.
   * @param {number} now
   */
  move(now) {
    if (this.start === null || this.target === null) return false;
    const share = Math.min(1, (now - this.start.at) / GLIDE);
    const eased = 1 - (1 - share) ** 3;
    this.low = this.start.low + (this.target[0] - this.start.low) * eased;
    this.high = this.start.high + (this.target[1] - this.start.high) * eased;
    if (share === 1) this.start = null;
    return share < 1;
  }
}

/**
 * A column between two rows as minima and maxima of at most some 120 bins, the first of which is number `from`; null
 * without any.
 * @param {Samples} samples
 * @param {string} name
 * @param {number} first
 * @param {number} last
 * @returns {Bins | null}
 */
export function bins(samples, name, first, last) {
  const power = samples.power(first, last, 120);
  const source = samples.source(name, power);
  if (!source || last <= first) return null;
  const each = source.rows;
  const from = Math.floor(first / each);
  const low = [];
  const high = [];
  for (let bin = from; bin * each < last; bin += 1) {
    low.push(source.low[bin & source.mask]);
    high.push(source.high[bin & source.mask]);
  }
  return {low, high, each, from};
}

/**
 * The range of bins without the outermost `share` of them on either side; null where none has a value.
 * @param {Bins | null} found
 * @param {number} share
 * @returns {[number, number] | null}
 */
export function quantiles(found, share) {
  /** @param {number[]} values */
  const known = (values) => values.filter((value) => value === value).sort((a, b) => a - b);
  const low = known(found?.low ?? []);
  const high = known(found?.high ?? []);
  if (low.length === 0 || high.length === 0) return null;
  return [low[Math.floor(share * low.length)], high[Math.ceil((1 - share) * high.length) - 1]];
}
