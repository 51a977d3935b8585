// The order of a table's rows by one of its columns, and which values are the best. Small values are better.

import {h} from '../common/dom.js';
import {t} from '../i18n/words.js';

/** @import {Child} from '../types/dom.js' */

const ALIKE = 0.01; // of the smallest value: a difference that says nothing

/**
 * The places of the smallest value and of those within 1 % of it; none without a larger value to compare with.
 * @param {readonly (number | null | undefined)[]} values
 * @returns {Set<number>}
 */
export function best(values) {
  const known = values.flatMap((value, place) =>
    typeof value === 'number' && Number.isFinite(value) ? [{value, place}] : [],
  );
  const least = Math.min(...known.map(({value}) => value));
  const limit = least + ALIKE * Math.abs(least);
  const first = known.filter(({value}) => value <= limit);
  return new Set(first.length < known.length ? first.map(({place}) => place) : []);
}

/**
 * The places of rows from the smallest value to the largest; rows without one come last. Equal rows keep their order.
 * @param {readonly (number | null | undefined)[]} values
 * @returns {number[]}
 */
export function ascending(values) {
  /** @param {number} place */
  const of = (place) => {
    const value = values[place];
    return typeof value === 'number' && Number.isFinite(value) ? value : Infinity;
  };
  return values.map((_, place) => place).sort((a, b) => (of(a) === of(b) ? a - b : of(a) < of(b) ? -1 : 1));
}

/**
 * The heading of a column by which rows are sorted: pressed again, they have the order in which they were added.
 * @param {{words: Child, name: string, sorted: boolean, act: () => void}} column   `name`: for screen readers
 */
export const sortButton = ({words, name, sorted, act}) =>
  h(
    'button',
    {
      type: 'button',
      class: 'sort',
      'aria-pressed': String(sorted),
      'aria-label': t('page.comparison.sort', {column: name}),
      onclick: act,
    },
    words,
    h('span', {class: 'arrow', 'aria-hidden': 'true'}, sorted ? '↑' : ''),
  );
