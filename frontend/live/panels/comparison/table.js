// The comparison as a full table below the scope: every estimate of every observer over the window that the scope
// shows. The scope gives way; columns are sorted by their headings and left out by a menu.

import {fill, h, query} from '../../../common/dom.js';
import {get} from '../../../common/api.js';
import {plain} from '../../../common/names.js';
import {createColumnsMenu} from '../../../widgets/columns-menu.js';
import {ascending, best, sortButton} from '../../../widgets/ordering.js';
import {chip, heading, link} from '../../../widgets/controls.js';
import {kindName} from '../../../widgets/kind-name.js';
import {Form} from './column-format.js';
import {number, settling} from './compare-observer.js';
import {short} from './comparison.js';
import {columnsOf, csvOf} from './table-columns.js';
import {t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {Column} from './table-columns.js' */

const EVERY = 1000; // ms between two requests
const LONGEST = 6000; // rows of a window of "all"

/** @typedef {{words: string, value: number | null, title: string}} Cell */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  /** @type {service.WindowTable | null} */
  let latest = null;
  /** @type {string | null} the column that orders the rows */
  let sorted = null;
  /** @type {[number, number]} */
  let window = [0, 0];
  let asking = 0; // number of the newest request: answers to earlier ones are dropped
  let shape = ''; // the columns that the heading has
  /** @type {Map<string, Form>} */
  let forms = new Map();
  let last = 0;
  /** @type {ReturnType<typeof setTimeout> | 0} */
  let late = 0;
  const menu = createColumnsMenu('live-comparison', () => build());
  const head = h('thead');
  const body = h('tbody');
  const range = h('span', {class: 'soft range'});
  const scroll = h('div', {class: 'wide', tabindex: 0, role: 'region'});

  /** The words of a column, for the menu, a screen reader and the file. @param {Column} column */
  const wordsOf = ({group, name}) => `${groupWords(group)} ${plain(name)}`;

  const build = () => {
    element.hidden = !app.state.table || !app.state.plant;
    document.documentElement.classList.toggle('tabled', !element.hidden);
    if (element.hidden) return;
    shape = '';
    scroll.setAttribute('aria-label', t('page.comparison.title'));
    fill(scroll, h('table', {}, h('caption', {class: 'visually-hidden'}, t('page.comparison.full.hint')), head, body));
    fill(
      element,
      heading(
        t('page.comparison.title'),
        range,
        menu.root,
        link('CSV', download, {title: t('page.comparison.csv.hint')}),
        link(t('page.action.close'), () => close(), {'data-act': 'close-table'}),
      ),
      scroll,
    );
    show();
    compute();
  };
  const close = () => {
    app.act.table(false);
    const opener = document.querySelector('[data-open="table"]');
    if (opener instanceof HTMLElement) opener.focus();
  };
  /** @returns {[number, number]} */
  const span = () => {
    const {t: now, window: length, selection} = app.state;
    return selection ?? [Math.max(0, now - (length ?? LONGEST * app.state.record)), now];
  };
  /** Ask the server for the figures of the window. */
  const compute = async () => {
    const {session} = app.state;
    if (element.hidden || !session) return;
    const number = (asking += 1);
    const asked = span();
    const query = new URLSearchParams({from: String(asked[0]), to: String(asked[1])});
    try {
      /** @type {service.WindowTable} */
      const answer = await get(`/api/sessions/${encodeURIComponent(session)}/comparison/table?${query}`);
      if (number !== asking) return;
      [latest, window] = [answer, asked];
      show();
    } catch {
      /* the session has ended: its last figures stay */
    }
  };
  /** The columns that are shown, with the figure of each observer. @returns {{column: Column, cells: Cell[]}[]} */
  const shown = () => {
    if (!latest) return [];
    const table = latest;
    const all = columnsOf(table);
    menu.show(all.map((column) => [column.key, wordsOf(column)]));
    return all
      .filter(({key}) => menu.shows(key))
      .map((column) => ({column, cells: table.observers.map(({estimates}) => cell(column, estimates))}));
  };
  /** @param {Column} column @param {service.EstimateInWindow[]} estimates @returns {Cell} */
  const cell = (column, estimates) => {
    const estimate = estimates.find(({name}) => name === column.estimate);
    const {words, value, title} = !estimate
      ? {words: '–', value: undefined, title: ''}
      : column.group === 'settle'
        ? settling(estimate)
        : {words: undefined, ...number(column.group === 'rmse' ? estimate.rmse : estimate.noise)};
    const form = forms.get(column.group === 'settle' ? column.key : column.group + column.estimate) ?? new Form();
    if (words === undefined) forms.set(column.group + column.estimate, form);
    if (words === undefined && value !== undefined) form.take([value]);
    const known = value !== undefined && Number.isFinite(value) ? value : null;
    return {words: words ?? form.write(value ?? NaN), value: known, title};
  };
  const show = () => {
    if (element.hidden) return;
    range.textContent = latest
      ? t('page.comparison.range', {from: window[0].toFixed(1), to: window[1].toFixed(1)})
      : '';
    shown(); // once for the form of the numbers
    const columns = shown();
    const names = `${columns.map(({column}) => column.key).join()} ${sorted}`;
    if (names !== shape) buildHead(columns.map(({column}) => column));
    shape = names;
    const labels = latest?.observers.map(({label}) => label) ?? [];
    const order = columns.find(({column}) => column.key === sorted)?.cells.map(({value}) => value);
    const firsts = columns.map(({cells}) => best(cells.map(({value}) => value)));
    fill(
      body,
      (order ? ascending(order) : labels.map((_, place) => place)).map((row) =>
        h(
          'tr',
          {},
          whoIs(labels[row], app),
          columns.map(({cells}, place) =>
            h(
              'td',
              {class: firsts[place].has(row) ? 'best' : null, title: cells[row].title, 'data-value': cells[row].value},
              cells[row].words,
            ),
          ),
        ),
      ),
    );
  };
  /** Two lines: what is measured, and of which estimate. @param {Column[]} columns */
  const buildHead = (columns) => {
    const groups = [...new Set(columns.map(({group}) => group))];
    fill(
      head,
      h(
        'tr',
        {},
        h('td', {rowspan: 2}),
        groups.map((group) =>
          h(
            'th',
            {
              scope: 'colgroup',
              colspan: columns.filter((column) => column.group === group).length,
              title: t(`page.comparison.${group}.hint`),
            },
            groupWords(group),
          ),
        ),
      ),
      h('tr', {}, columns.map(columnHead)),
    );
  };
  /** @param {Column} column @param {number} place @param {Column[]} all */
  const columnHead = (column, place, all) => {
    const {plant} = app.state;
    const items = column.estimate.startsWith('x.') ? plant?.states : plant?.channels;
    return h(
      'th',
      {
        scope: 'col',
        'data-key': column.key,
        class: all[place - 1]?.group === column.group ? null : 'first',
        'aria-sort': sorted === column.key ? 'ascending' : null,
      },
      sortButton({
        words: short(column.name, items ?? [], app, column.group === 'noise'),
        name: wordsOf(column),
        sorted: sorted === column.key,
        act: () => {
          sorted = sorted === column.key ? null : column.key;
          show();
          query(`[data-key="${CSS.escape(column.key)}"] .sort`, head).focus();
        },
      }),
    );
  };
  const download = () => {
    if (!latest) return;
    const file = new Blob([csvOf(latest)], {type: 'text/csv'});
    const address = URL.createObjectURL(file);
    h('a', {href: address, download: 'comparison.csv'}).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  };
  app.subscribe(
    (s) => [s.table, s.plant, s.language, s.columns, s.session],
    () => {
      forms = new Map();
      build();
    },
  );
  app.subscribe((s) => [s.observers], show);
  app.onTick(() => {
    if (element.hidden) return;
    late ||= setTimeout(
      () => {
        [late, last] = [0, performance.now()];
        compute();
      },
      Math.max(0, last + EVERY - performance.now()),
    );
  });
}

/** @param {Column['group']} group */
function groupWords(group) {
  if (group === 'rmse') return 'RMSE';
  return group === 'settle' ? t('page.comparison.settle') : t('page.comparison.noise');
}

/**
 * The heading of an observer's row.
 * @param {string} label
 * @param {App} app
 */
function whoIs(label, app) {
  const observer = app.state.observers.find((one) => one.label === label);
  const kind = observer?.kind ?? '';
  return h(
    'th',
    {scope: 'row', title: observer ? `${label}, ${kindName({id: kind, title: kind})}` : label},
    h('span', {class: 'who'}, observer && chip(observer.colour, observer.dashed), h('span', {}, label)),
  );
}
