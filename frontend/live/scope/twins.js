// Observers whose curves coincide with those of an earlier one in all strips that both are in. Pure.

/** @import {Samples, Strip} from '../types.js' */

const POINTS = 60; // compared in each strip
const FEWEST = 20; // of these that both must have
const ALIKE = 1; // px between two curves on average: nobody sees that there are two
const APART = 2; // px from which on curves that coincided are two again

/** @typedef {{strip: Strip, range: {low: number, high: number}, height: number}} Drawn */

/**
 * The labels of the later observers of each pair that coincides.
 * @param {Drawn[]} rows
 * @param {string[]} labels   observers in their order
 * @param {Samples} samples
 * @param {[number, number]} span
 * @param {readonly string[]} before   those that coincided
 * @returns {string[]}
 */
export function coincident(rows, labels, samples, span, before) {
  return labels.filter((label, place) => {
    const most = before.includes(label) ? APART : ALIKE;
    return labels.slice(0, place).some((other) => alike(rows, other, label, samples, span, most));
  });
}

/**
 * @param {Drawn[]} rows
 * @param {string} one
 * @param {string} other
 * @param {Samples} samples
 * @param {[number, number]} span
 * @param {number} most
 */
function alike(rows, one, other, samples, span, most) {
  let shared = 0;
  for (const {strip, range, height} of rows) {
    const pair = [one, other].map((label) => strip.traces.find((trace) => trace.label === label)?.column);
    if (pair[0] === undefined || pair[1] === undefined || height <= 0) continue;
    const distance = meanDistance(pair[0], pair[1], samples, span);
    if (distance === null || (distance / (range.high - range.low)) * height >= most) return false;
    shared += 1;
  }
  return shared > 0;
}

/**
 * The mean distance of two columns; null where too few rows have both.
 * @param {string} one
 * @param {string} other
 * @param {Samples} samples
 * @param {[number, number]} span
 */
function meanDistance(one, other, samples, [t0, t1]) {
  const first = Math.max(0, Math.floor(t0 / samples.record));
  const last = Math.min(samples.rows - 1, Math.ceil(t1 / samples.record));
  const step = Math.max(1, (last - first) / POINTS);
  let sum = 0;
  let count = 0;
  for (let row = first; row <= last; row += step) {
    const gap = Math.abs(samples.value(one, Math.round(row)) - samples.value(other, Math.round(row)));
    if (!(gap >= 0)) continue;
    sum += gap;
    count += 1;
  }
  return count < FEWEST ? null : sum / count;
}
