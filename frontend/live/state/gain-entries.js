// The numbers of a gain: a number, a column (a list) or a matrix (a list of rows).

/** @import {Gain} from '../types.js' */
/** @import * as service from '../../types/service.js' */

/**
 * Every entry with its place: [] for a number, [i] in a column, [i, j] in a matrix.
 * @param {Gain | null} value
 * @param {number[]} [place]
 * @returns {{place: number[], value: number | null}[]}
 */
export function entriesOf(value, place = []) {
  if (!Array.isArray(value)) return [{place, value}];
  return value.flatMap((part, index) => entriesOf(part, [...place, index]));
}

/**
 * The gain with another number at a place.
 * @param {Gain} value
 * @param {number[]} place
 * @param {number} next
 * @returns {Gain}
 */
export function withEntry(value, place, next) {
  const [row, column] = place;
  if (row === undefined || !Array.isArray(value)) return next;
  if (column === undefined) return value.flat().map((part, at) => (at === row ? next : part));
  return value.map((part, at) => [part].flat().map((one, k) => (at === row && k === column ? next : one)));
}

/**
 * The labels of a place, such as "x1" or "x1, y"; its number where there are no labels; nothing for a number.
 * @param {number[]} place
 * @param {service.GainLabels} [labels]
 */
export function placeName(place, labels) {
  const lists = [labels?.rows, labels?.columns];
  return place.map((index, level) => lists[level]?.[index] ?? String(index + 1)).join(', ');
}
