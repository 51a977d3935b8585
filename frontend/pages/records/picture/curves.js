// Curves of thinned series: ranges of axes, paths in a box of 1000 × 100, and places of marks. Pure.

/** @typedef {readonly (number | null)[]} Values */

export const WIDTH = 1000;
export const HEIGHT = 100;
const ROOM = 0.08; // of the range, above and below

/**
 * The range of an axis that shows all values, with a little room.
 * @param {Values} low
 * @param {Values} high
 * @param {{line?: number, most?: number, logarithmic?: boolean}} [options]
 * @returns {[low: number, high: number]}
 */
export function range(low, high, {line, most = Infinity, logarithmic = false} = {}) {
  let [least, largest] = [Infinity, -Infinity];
  for (const one of low) if (one !== null) least = Math.min(least, one);
  for (const one of high) if (one !== null) largest = Math.max(largest, Math.min(one, most));
  if (line !== undefined) [least, largest] = [Math.min(least, line), Math.max(largest, line)];
  if (logarithmic) {
    largest = Math.max(largest, 1e-12);
    least = Math.max(least, largest * 1e-4);
    return [least / 1.3, largest * 1.3];
  }
  if (!Number.isFinite(least) || !Number.isFinite(largest)) return [0, 1];
  const span = largest - least || Math.abs(largest) * 0.1 || 1;
  return [least - ROOM * span, largest + ROOM * span];
}

/**
 * The height in the box at which a value is drawn, 0 at the top.
 * @param {[number, number]} limits
 * @param {boolean} [logarithmic]
 * @returns {(value: number) => number}
 */
export function heights([low, high], logarithmic = false) {
  /** @param {number} value */
  const scale = (value) => (logarithmic ? Math.log(Math.max(value, low)) : value);
  const [bottom, top] = [scale(low), scale(high)];
  return (value) => Math.min(HEIGHT, Math.max(0, HEIGHT * (1 - (scale(value) - bottom) / (top - bottom))));
}

/**
 * The path through the smallest and largest value of each interval; a gap where several in a row have none. With few
 * rows, an interval may lie between two of them.
 * @param {Values} low
 * @param {Values} high
 * @param {(value: number) => number} height
 * @param {boolean} [held]   values stay until the next one
 * @param {number} [bridged]   intervals without values that make no gap
 */
export function path(low, high, height, held = false, bridged = 1) {
  const parts = [];
  let drawing = false;
  let empty = 0;
  let last = NaN;
  const step = WIDTH / low.length;
  for (let k = 0; k < low.length; k += 1) {
    const [least, largest] = [low[k], high[k]];
    if (least === null || largest === null) {
      empty += 1;
      drawing &&= empty <= bridged;
      continue;
    }
    const x = (step * k).toFixed(1);
    const ends = [height(least), height(largest)];
    if (Math.abs(ends[1] - last) < Math.abs(ends[0] - last)) ends.reverse();
    if (!drawing) parts.push(`M${x} ${ends[0].toFixed(1)}`);
    else parts.push(held ? `H${x}V${ends[0].toFixed(1)}` : `L${x} ${ends[0].toFixed(1)}`);
    if (Math.abs(ends[1] - ends[0]) >= 0.05) parts.push(`V${ends[1].toFixed(1)}`);
    [drawing, empty, last] = [true, 0, ends[1]];
  }
  if (drawing && held) parts.push(`H${WIDTH}`);
  return parts.join('');
}

/**
 * The path through values at times; a gap where one is missing.
 * @param {readonly number[]} t
 * @param {Values} values
 * @param {number} end   time at the right edge
 * @param {(value: number) => number} height
 */
export function line(t, values, end, height) {
  let drawing = false;
  return values
    .map((value, k) => {
      const command = drawing ? 'L' : 'M';
      drawing = value !== null;
      return value === null ? '' : `${command}${((WIDTH * t[k]) / end).toFixed(1)} ${height(value).toFixed(1)}`;
    })
    .join('');
}

/**
 * A range widened to show another curve, as far as that is at most as far outside as the range is wide.
 * @param {[number, number]} limits
 * @param {Values} values
 * @returns {[number, number]}
 */
export function widened([low, high], values) {
  const span = high - low;
  let [least, largest] = [low, high];
  for (const value of values) {
    if (value === null) continue;
    least = Math.min(least, Math.max(value, low - span));
    largest = Math.max(largest, Math.min(value, high + span));
  }
  return [least, largest];
}

/**
 * The area between two curves; nothing where one is missing.
 * @param {readonly number[]} t
 * @param {Values} low
 * @param {Values} high
 * @param {number} end   time at the right edge
 * @param {(value: number) => number} height
 */
export function area(t, low, high, end, height) {
  /** @type {number[][]} */
  const stretches = [[]];
  t.forEach((_, k) => {
    if (low[k] === null || high[k] === null) stretches.push([]);
    else stretches[stretches.length - 1].push(k);
  });
  /** @param {number} k @param {Values} values */
  const point = (k, values) => `${((WIDTH * t[k]) / end).toFixed(1)} ${height(Number(values[k])).toFixed(1)}`;
  return stretches
    .filter((one) => one.length > 1)
    .map((one) => {
      const there = one.map((k) => point(k, low));
      const back = one.map((k) => point(k, high)).reverse();
      return `M${[...there, ...back].join('L')}Z`;
    })
    .join('');
}

/**
 * The range of estimates: of the curves after their first tenth, in which they settle; with zero if it is asked for.
 * @param {readonly {values: Values}[]} curves
 * @param {boolean} [zero]
 * @returns {[low: number, high: number]}
 */
export function rangeOfCurves(curves, zero = false) {
  const settled = curves.flatMap(({values}) => values.slice(Math.floor(values.length / 10)));
  return range(settled, zero ? [...settled, 0] : settled, zero ? {line: 0} : {});
}

/**
 * Places of marks, as shares of the width, moved apart so that none covers another; their order stays.
 * @param {readonly number[]} places
 * @param {number} gap
 * @returns {number[]}
 */
export function apart(places, gap) {
  const order = places.map((_, index) => index).sort((a, b) => places[a] - places[b]);
  /** @type {number[]} */
  const moved = [...places];
  const room = Math.min(gap, 1 / Math.max(1, places.length));
  let last = -Infinity;
  for (const index of order) last = moved[index] = Math.max(places[index], last + room);
  let next = 1 + room;
  for (const index of order.reverse()) next = moved[index] = Math.min(moved[index], next - room);
  return moved;
}
