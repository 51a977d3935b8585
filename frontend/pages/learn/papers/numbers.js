// The numbers of a paper: as printed, as measured here in a run, and by an independent computation.

import {reason} from '../../../common/api.js';
import {fill, h, number} from '../../../common/dom.js';
import {named, t} from '../../../i18n/words.js';
import {withSymbols} from '../../../widgets/prose.js';
import {measuredIn} from './results.js';

/** @import * as service from '../../../types/service.js' */

/** @param {readonly service.PaperNumber[]} numbers */
export function numbersTable(numbers) {
  const cells = numbers.map(() => h('td', {class: 'papers-value'}, '…'));
  for (const experiment of new Set(numbers.map((one) => one.experiment))) {
    const places = numbers.flatMap((one, place) => (one.experiment === experiment ? [place] : []));
    measuredIn(places.map((place) => numbers[place])).then(
      (values) => places.forEach((place, n) => showValue(cells[place], numbers[place], values[n])),
      (error) => places.forEach((place) => fill(cells[place], h('span', {class: 'alarm'}, reason(error).message))),
    );
  }
  return h(
    'div',
    {class: 'papers-scroll', tabindex: 0, role: 'region', 'aria-label': t('page.papers.numbers')},
    h(
      'table',
      {},
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          h('th', {scope: 'col'}, t('page.papers.column.quantity')),
          h('th', {scope: 'col'}, t('page.papers.column.paper')),
          h('th', {scope: 'col'}, t('page.papers.column.here')),
          h('th', {scope: 'col'}, t('page.papers.column.independent')),
        ),
      ),
      h(
        'tbody',
        {},
        numbers.map((one, place) =>
          h(
            'tr',
            {},
            h('th', {scope: 'row'}, withSymbols(named(one.what))),
            h('td', {}, one.printed ? named(one.printed) : '–'),
            cells[place],
            h('td', {class: 'soft'}, one.expected === null ? '–' : independent(one)),
          ),
        ),
      ),
    ),
  );
}

/** @param {service.PaperNumber} one */
const independent = ({expected, within, unit}) =>
  expected === 0 ? `< ${withUnit(within, unit)}` : `${number(expected)} ± ${withUnit(within, unit)}`;

/** @param {number} value @param {string} unit */
const withUnit = (value, unit) => (unit ? `${number(value)} ${unit}` : number(value));

/** @param {HTMLElement} cell @param {service.PaperNumber} one @param {number | null} value */
export function showValue(cell, {expected, within, unit}, value) {
  const agrees = expected === null || (value !== null && Math.abs(value - expected) <= within);
  cell.classList.toggle('differs', !agrees);
  fill(
    cell,
    value === null ? '–' : withUnit(value, unit),
    expected !== null &&
      h(
        'span',
        {class: agrees ? 'papers-agrees' : 'alarm'},
        ` ${agrees ? t('page.papers.agrees') : t('page.papers.differs')}`,
      ),
  );
}
