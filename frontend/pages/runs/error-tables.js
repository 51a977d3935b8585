// Tables of the comparison: errors between the events of a run, and how soon estimates followed the steps of the
// faults.

import {h, number, symbol} from '../../common/dom.js';
import {small} from '../../diagnosis/fault-size.js';
import {t} from '../../i18n/words.js';

/** @import {Comparison, ComparisonRow, Plant} from '../types.js' */

/**
 * Root mean square errors, a row for each quantity and observer, a column for each stretch between two events; the
 * largest error when pointed at.
 * @param {Comparison['windows']} windows
 * @param {ComparisonRow[]} rows
 * @param {(place: number) => HTMLElement} chip
 * @param {(label: string) => number} place
 * @param {Plant} plant
 */
export function errors(windows, rows, chip, place, plant) {
  const columns = [...new Set(rows.flatMap((row) => Object.keys(row.rmse)))];
  const units = new Map([...plant.states, ...plant.channels].map((item) => [item.name, item.unit]));
  const head = h(
    'tr',
    {},
    h('td'),
    windows.map(({start, end}) => h('th', {scope: 'col'}, `${number(start, 3)}–${number(end, 3)} s`)),
  );
  /** @param {string} column */
  const group = (column) => {
    const [kind, name] = column.split('.');
    const own = rows.filter((row) => row.rmse[column]);
    return h(
      'tbody',
      {},
      h(
        'tr',
        {class: 'group'},
        h(
          'th',
          {colspan: windows.length + 1, scope: 'rowgroup'},
          symbol(name, kind === 'theta'),
          h('small', {}, units.get(name)),
        ),
      ),
      own.map((row) =>
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, chip(place(row.label)), row.label),
          row.rmse[column].map((value, k) =>
            h('td', {title: t('page.runs.peak', {value: small(row.peak[column]?.[k], 3)})}, small(value, 3)),
          ),
        ),
      ),
    );
  };
  return h('table', {class: 'measures'}, h('thead', {}, head), columns.map(group));
}

/**
 * Seconds until each estimate stays within 10 % and 5 % of each step.
 * @param {ComparisonRow[]} rows
 * @param {(place: number) => HTMLElement} chip
 * @param {(label: string) => number} place
 */
export function settling(rows, chip, place) {
  const own = rows.filter((row) => row.steps.length);
  const [{steps}] = own;
  /** @param {number | null} value */
  const time = (value) => (value === null ? '–' : number(value, 2));
  return h(
    'table',
    {class: 'measures'},
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('td'),
        steps.map(({channel, at}) => h('th', {scope: 'col'}, symbol(channel), h('small', {}, `${number(at, 3)} s`))),
      ),
    ),
    h(
      'tbody',
      {},
      own.map((row) =>
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, chip(place(row.label)), row.label),
          steps
            .map(({channel, at}) => row.steps.find((one) => one.channel === channel && one.at === at))
            .map((step) => h('td', {}, step ? `${time(step.ten)} / ${time(step.five)}` : '–')),
        ),
      ),
    ),
  );
}
