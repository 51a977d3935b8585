// What the unit tests of the page share: reproducible random numbers, and samples made of columns.

import {Samples} from '../../frontend/live/state/samples.js';

/**
 * A generator of reproducible numbers in [0, 1).
 * @param {number} seed
 */
export function randomNumbers(seed) {
  let state = seed;
  return () => (state = (state * 1664525 + 1013904223) % 4294967296) / 4294967296;
}

/**
 * Samples that hold these columns, all of one length.
 * @param {{[name: string]: ArrayLike<number>}} columns
 * @param {number} record  s between rows
 */
export function samplesOf(columns, record = 1) {
  const samples = new Samples(record);
  const names = Object.keys(columns);
  samples.setColumns(names);
  const count = columns[names[0]].length;
  samples.push(0, count, Float32Array.from(names.flatMap((name) => Array.from(columns[name]))));
  return samples;
}
