// Prose with symbols in italics (θ̂1, λmin, ρ), **bold** words, and {name} for a measured number.

import {h, hatted, number} from '../common/dom.js';

/** @import {Child} from '../types/dom.js' */

const SYMBOL = /λmin|(?<![A-Za-z])([θφρλxyhuqKHLR]\u0302?|ŷ)(\d*)(?![A-Za-z\u0302])/g;
const LETTERS = /^[qh]$/; // words of a sentence where they stand alone: only with an index or a hat are they symbols

/**
 * Words with their symbols in italics; the letter of each, with its hat, is its `data-symbol`.
 * @param {string} words
 * @returns {Child[]}
 */
export function withSymbols(words) {
  /** @type {Child[]} */
  const parts = [];
  let at = 0;
  const text = words.replaceAll('ŷ', 'y\u0302');
  for (const match of text.matchAll(SYMBOL)) {
    if (LETTERS.test(match[0])) continue;
    parts.push(text.slice(at, match.index));
    at = match.index + match[0].length;
    const mark = (/** @type {Child[]} */ ...symbol) => h('span', {'data-symbol': match[1] ?? match[0]}, symbol);
    parts.push(
      match[0] === 'λmin'
        ? mark(h('i', {}, 'λ'), h('sub', {}, 'min'))
        : mark(match[1].length > 1 ? hatted(match[1][0]) : h('i', {}, match[1]), match[2] && h('sub', {}, match[2])),
    );
  }
  return [...parts, text.slice(at)];
}

/**
 * Put measured numbers in the place of {name}; those that are missing become a dash.
 * @param {string} text
 * @param {{[name: string]: number | null}} values
 */
export const filled = (text, values) => text.replace(/\{(\w+)\}/g, (_, name) => number(values[name], 3));

/**
 * A paragraph: **bold** words, symbols, measured numbers.
 * @param {string} text
 * @param {{[name: string]: number | null}} [values]
 * @returns {Child[]}
 */
export const prose = (text, values = {}) =>
  filled(text, values)
    .split(/\*\*/)
    .map((part, place) => (place % 2 ? h('b', {}, withSymbols(part)) : withSymbols(part)));
