// The tables of a comparison: settings that differ, and measures to sort by, of which columns can be left out.

import {fill, h, number} from '../../../common/dom.js';
import {createColumnsMenu} from '../../../widgets/columns-menu.js';
import {labelOf, nameOf, valueOf} from '../notebook/line-words.js';
import {t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */

/** A line in the colour of a run. @param {number} place */
export const swatch = (place) =>
  h('span', {class: 'swatch', style: `background:var(--o${place})`, 'aria-hidden': 'true'});

/**
 * The settings that differ. Of runs of different plants those that only some have are folded.
 * @param {service.RunComparison} found
 */
export function differences({runs, differences: rows, same}) {
  const common = new Set(runs.map((run) => run.plant)).size > 1 ? rows.filter(givenInAll) : rows;
  const others = rows.filter((row) => !common.includes(row));
  return [
    h('h2', {}, t('page.compare.differs')),
    common.length > 0 && settingsTable(runs, common),
    others.length > 0 &&
      h('details', {}, h('summary', {}, t('page.compare.some', {n: others.length})), settingsTable(runs, others)),
    h('p', {class: 'soft small'}, rows.length ? t('page.compare.same', {n: same}) : t('page.compare.all-same')),
  ];
}

/** @param {service.RunComparison['differences'][number]} row */
const givenInAll = ({values}) => values.every((value) => value !== null);

/**
 * @param {service.RunComparison['runs']} runs
 * @param {service.RunComparison['differences']} rows
 */
function settingsTable(runs, rows) {
  const heads = runs.map((run, place) =>
    h('th', {class: 'r', title: nameOf(run)}, swatch(place), h('span', {class: 'unseen'}, nameOf(run))),
  );
  const table = h(
    'table',
    {class: 'compare-table settings'},
    h('thead', {}, h('tr', {}, h('th', {}, t('page.compare.setting')), heads)),
    h(
      'tbody',
      {},
      rows.map(({label, values}) =>
        h(
          'tr',
          {},
          h('th', {}, labelOf(label)),
          values.map((value) => {
            const text = valueOf(value) || '–';
            return h('td', {class: `r${value === values[0] ? '' : ' other'}`, title: text}, h('span', {}, text));
          }),
        ),
      ),
    ),
  );
  return h('div', {class: 'wide', tabindex: 0, role: 'group', 'aria-label': t('page.compare.differs')}, table);
}

/**
 * The card of measures.
 * @param {HTMLElement} root
 */
export function createMeasures(root) {
  /** @type {string | null} the measure by which runs are sorted */
  let sorted = null;
  /** @type {service.RunComparison | null} */
  let latest = null;
  const menu = createColumnsMenu('measures', () => latest && show(latest));
  const body = h('div', {class: 'wide', tabindex: 0});
  fill(
    root,
    h('div', {class: 'heading'}, h('h2', {}, t('page.compare.measures')), menu.root),
    body,
    h('p', {class: 'soft small'}, t('page.compare.measures.hint')),
  );

  /** @param {string} key */
  function sortBy(key) {
    sorted = sorted === key ? null : key;
    if (latest) show(latest);
    const button = body.querySelector(`[data-key="${CSS.escape(key)}"]`);
    if (button instanceof HTMLElement) button.focus();
  }

  /** @param {service.RunComparison} found */
  function show(found) {
    latest = found;
    const {runs, observers} = found;
    const all = found.measures.map((one) => ({...one, key: keyOf(one)}));
    menu.show(all.map(({key, label}) => [key, labelOf(label)]));
    const measures = all.filter(({key}) => menu.shows(key));
    const by = measures.find(({key}) => key === sorted)?.values;
    const order = runs.map((_, place) => place);
    if (by) order.sort((a, b) => (by[a] ?? Infinity) - (by[b] ?? Infinity));
    const best = measures.map(({values}) => {
      const known = values.filter((value) => value !== null);
      return known.length > 1 && Math.max(...known) > Math.min(...known) ? Math.min(...known) : null;
    });
    const headings = measures.map(({key, label}) =>
      h(
        'th',
        {class: 'r', 'aria-sort': sorted === key ? 'ascending' : null},
        h(
          'button',
          {type: 'button', 'data-key': key, onclick: () => sortBy(key)},
          labelOf(label),
          sorted === key && ' ↑',
        ),
      ),
    );
    const rows = order.map((run) =>
      h(
        'tr',
        {},
        h('th', {}, swatch(run), ' ', nameOf(runs[run]), observers[run] && h('small', {}, ' ', observers[run])),
        measures.map(({unit, values}, place) => {
          const text = values[run] === null ? '–' : `${number(values[run], 3)}${unit && ` ${unit}`}`;
          return h('td', {class: 'r'}, values[run] !== null && values[run] === best[place] ? h('b', {}, text) : text);
        }),
      ),
    );
    fill(
      body,
      h(
        'table',
        {class: 'compare-table'},
        h('thead', {}, h('tr', {}, h('th', {}, t('page.compare.run')), headings)),
        h('tbody', {}, rows),
      ),
    );
  }
  return {show};
}

/** What tells a measure from the others, in every language. @param {service.MeasureRow} measure */
const keyOf = ({label}) => `${label.code}:${label.args?.name ?? ''}`;
