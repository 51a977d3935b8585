// A table of times and values as text, one point a line: what is typed or pasted becomes a signal.

/** @import {Signal} from './shapes.js' */

export const MOST_POINTS = 5000;

/**
 * The points of a table or of steps as lines.
 * @param {{times: number[], values: number[]}} points
 */
export const asText = ({times, values}) => times.map((time, k) => `${short(time)}  ${short(values[k])}`).join('\n');

/** @param {number} value */
const short = (value) => String(Number(value.toPrecision(9)));

/**
 * The points in a text; times and values are separated by blanks, semicolons, tabs or (where there are none) commas.
 * @param {string} text
 * @returns {{times: number[], values: number[]} | {problem: {code: string, args: {line?: number, n?: number}}}}
 */
export function pointsOf(text) {
  /** @type {number[]} */
  const times = [];
  /** @type {number[]} */
  const values = [];
  for (const [place, line] of text.split('\n').entries()) {
    const plain = line.trim().replaceAll('−', '-');
    if (plain === '') continue;
    const parts = /[\s;]/.test(plain)
      ? plain.split(/\s*;\s*|\s+/).map((part) => part.replace(',', '.'))
      : plain.split(',');
    const [time, value] = parts.map(Number);
    if (parts.length !== 2 || parts.includes('') || !Number.isFinite(time) || !Number.isFinite(value))
      return {problem: {code: 'page.inputs.table.line', args: {line: place + 1}}};
    if (times.length && time <= times[times.length - 1])
      return {problem: {code: 'page.inputs.table.order', args: {line: place + 1}}};
    times.push(time);
    values.push(value);
  }
  if (times.length === 0) return {problem: {code: 'page.inputs.table.empty', args: {}}};
  if (times.length > MOST_POINTS) return {problem: {code: 'page.inputs.table.many', args: {n: MOST_POINTS}}};
  return {times, values};
}
