// The range that the axis of a strip should show, the marks beside it, and where curves leave it.

import {bins, marks, niceStep, quantiles} from './axes.js';
import {fixed, power, raised} from '../../widgets/number-format.js';

/** @import {DrawnStrip, Leaving, Range, Samples, Strip, Trace} from '../types.js' */

// share of an estimate's outermost samples that do not set the scale: its start, and the effect of other faults
const TRIMMED = 0.12;
const BEYOND = 0.6; // of that scale: what lies within it on either side is shown whole, so that noise is never cut
const BAND = 0.35; // the same for a confidence band, which may be as wide as it likes
const DIGITS = 7; // that fit beside an axis
const NEAR = 24; // of the window's width: what leaves the axis again within a share of it has one mark

/**
 * Rows of the samples between two times: [first, last).
 * @param {Samples} samples
 * @param {number} t0
 * @param {number} t1
 * @returns {[number, number]}
 */
function rowsOf(samples, t0, t1) {
  return [Math.max(0, Math.floor(t0 / samples.record)), Math.min(samples.rows, Math.ceil(t1 / samples.record) + 1)];
}

/**
 * The range of a strip between two times: all of the truth, most of the estimates with all of their noise, and their
 * bands as far as they leave the curves readable. A short throw far out stays off the axis and gets a mark
 * (`leaving`); `whole` shows that, too.
 * @param {Strip} strip
 * @param {Samples} samples
 * @param {number} t0
 * @param {number} t1
 * @param {boolean} [whole]
 * @returns {[number, number]}
 */
export function wanted(strip, samples, t0, t1, whole = false) {
  const [first, last] = rowsOf(samples, t0, t1);
  /** @type {[number, number] | null} */
  let range = strip.base;
  /** @param {[number, number] | null} found */
  const take = (found) => {
    if (found) range = range ? [Math.min(range[0], found[0]), Math.max(range[1], found[1])] : found;
  };
  if (last > first) {
    const traces = strip.traces.flatMap(({column}) => bins(samples, column, first, last) ?? []);
    for (const column of [strip.truth, strip.reading?.column])
      if (column) take(quantiles(bins(samples, column, first, last), 0));
    for (const found of traces) take(quantiles(found, whole ? 0 : TRIMMED));
    if (range && !whole) {
      const [bottom, top] = range;
      const tall = top - bottom;
      /** @param {number} share @returns {[number, number]} */
      const within = (share) => [bottom - share * tall, top + share * tall];
      const [fence, edge] = [within(BEYOND), within(BAND)];
      for (const {low, high} of traces)
        for (const value of [...low, ...high]) if (value >= fence[0] && value <= fence[1]) take([value, value]);
      for (const trace of strip.traces) if (trace.low) take(clipped(bandOf(samples, trace, first, last), edge));
    }
  }
  return range ? opened(strip, ...range) : [0, 1];
}

/**
 * @param {Samples} samples
 * @param {Trace} trace
 * @param {number} first
 * @param {number} last
 * @returns {[number, number] | null}
 */
const bandOf = (samples, {low, high}, first, last) => {
  if (low === undefined || high === undefined) return null;
  const under = quantiles(bins(samples, low, first, last), TRIMMED);
  const over = quantiles(bins(samples, high, first, last), TRIMMED);
  return under && over ? [under[0], over[1]] : null;
};

/**
 * @param {[number, number] | null} found
 * @param {[number, number]} limits
 * @returns {[number, number] | null}
 */
const clipped = (found, [low, high]) => found && [Math.max(low, found[0]), Math.min(high, found[1])];

/**
 * Residuals about zero, and no range narrower than it makes sense.
 * @param {Strip} strip
 * @param {number} low
 * @param {number} high
 * @returns {[number, number]}
 */
function opened(strip, low, high) {
  if (strip.kind === 'residual') [low, high] = [-Math.max(-low, high), Math.max(-low, high)];
  const least = Math.max(strip.least, 0.02 * Math.max(Math.abs(low), Math.abs(high))) || 1e-12;
  const middle = (low + high) / 2;
  return high - low < least ? [middle - least / 2, middle + least / 2] : [low, high];
}

/**
 * Where curves are beyond an axis: [{from, to} times, up, place of the colour, trace].
 * @param {Strip} strip
 * @param {Samples} samples
 * @param {number} t0
 * @param {number} t1
 * @param {[number, number]} limits
 * @returns {Leaving[]}
 */
export function leaving(strip, samples, t0, t1, [low, high]) {
  const [first, last] = rowsOf(samples, t0, t1);
  /** @type {Leaving[]} */
  const arrows = [];
  if (last <= first) return arrows;
  const near = (t1 - t0) / NEAR;
  strip.traces.forEach(({column, place}, trace) => {
    const binned = bins(samples, column, first, last);
    if (!binned) return;
    for (const {values, up} of [
      {values: binned.high, up: true},
      {values: binned.low, up: false},
    ]) {
      /** @type {Leaving | null} */
      let open = null;
      values.forEach((value, i) => {
        if (up ? !(value > high) : !(value < low)) return;
        const t = (binned.from + i + 0.5) * binned.each * samples.record;
        if (open && t - open.to < near) open.to = t;
        else arrows.push((open = {from: t, to: t, up, place, trace}));
      });
    }
  });
  return arrows;
}

/**
 * Two to four marks on a vertical axis, whole powers of ten on a logarithmic one, each as text that fits beside it.
 * @param {DrawnStrip} strip
 * @param {Range} range
 * @param {number} height
 */
export function setTicks(strip, range, height) {
  const span = range.high - range.low;
  if (!(span > 0)) return;
  let count = strip.log ? height / 30 : Math.max(2, height / (height < 80 ? 17 : 23));
  let step = strip.log ? Math.max(1, Math.round(niceStep(span, count))) : niceStep(span, count);
  const inside = () => marks(range.low + 0.05 * span, range.high - 0.05 * span, step).length;
  // one alone says nothing of the scale
  while (!strip.log && inside() < 2 && count < 10) step = niceStep(span, (count += 1));
  strip.ticks = marks(range.low, range.high, step);
  [strip.labels, strip.power] = strip.log
    ? [strip.ticks.map((value) => `10${raised(Math.round(value))}`), '']
    : tickTexts(strip.ticks, step);
}

/**
 * Marks in plain figures where they fit, else with one power of ten for all of them.
 * @param {number[]} ticks
 * @param {number} step
 * @returns {[string[], string]}
 */
export function tickTexts(ticks, step) {
  const most = Math.max(...ticks.map(Math.abs));
  /** @param {number} unit @param {number} places */
  const write = (unit, places) =>
    ticks.map((value) => (value === 0 ? '0' : (value / unit).toFixed(places).replace('-', '−')));
  const plain = write(1, placesOf(step));
  if (!(most > 0) || (most < 1e6 && plain.every((label) => label.length <= DIGITS))) return [plain, ''];
  const exponent = Math.floor(Math.log10(most) + 1e-9);
  const unit = 10 ** exponent;
  return [write(unit, Math.min(DIGITS - 3, placesOf(step / unit))), `·10${raised(exponent)}`];
}

/** @param {number} step */
const placesOf = (step) => Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));

/**
 * The form of the numbers beside a strip, the same for all of them; it follows from the axis.
 * @param {{low: number, high: number}} range
 * @returns {(value: number) => string}
 */
export function written({low, high}) {
  const places = Math.ceil(-Math.log10(high - low) + 2.05);
  if (places > 6 || Math.max(Math.abs(low), Math.abs(high)) >= 1e6)
    return (value) => (Number.isFinite(value) ? power(value) : '–');
  return (value) => fixed(value, Math.max(0, places));
}
