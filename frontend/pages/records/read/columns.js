// The table of columns: what each is taken for, in which unit, and why. Every guess can be changed.

import {fill, h, number, symbol} from '../../../common/dom.js';
import {hasWords, named, say, t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {heading, link} from '../../../widgets/controls.js';
import {assigned, withTime, withUnit} from '../mapping.js';
import {span} from '../numbers.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Inspection, Plant, RecordActions, RecordState} from '../types.js' */

const SHOWN = 8; // unused columns; more are folded
const unfolded = new Set(); // ids of records whose columns are all shown
const TIME_UNITS = /** @type {const} */ ([
  ...['s', 'ms', 'us', 'ns', 'min', 'h', 'd'],
  ...['epoch-s', 'epoch-ms', 'epoch-us', 'epoch-ns', 'datetime', 'clock', 'spreadsheet-days'],
]);

/**
 * The card with the table.
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function columnsCard({inspection, plant, work}, act) {
  if (!inspection) return null;
  const heads = ['column', 'cells', 'use', 'unit', 'meaning'].map((key) =>
    h('th', {scope: 'col', class: key}, t(`page.records.columns.${key}`)),
  );
  const missing = inspection.quantities.filter((one) => one.column === null);
  const unused = plant ? inspection.columns.filter((one) => one.role === 'unused') : inspection.columns.slice(SHOWN);
  const hidden = new Set(unused.length > SHOWN + 2 ? unused.slice(plant ? SHOWN : 0) : []);
  return h(
    'section',
    {
      class: `card columns-card${unfolded.has(inspection.id) ? ' unfolded' : ''}`,
      'aria-busy': work === 'mapping' ? 'true' : null,
    },
    heading(t('page.records.columns'), h('span', {class: 'soft aside'}, t('page.records.columns.hint'))),
    h(
      'table',
      {class: 'columns'},
      h('thead', {}, h('tr', {}, heads)),
      h(
        'tbody',
        {},
        inspection.times === null || inspection.mapping.time?.column === null ? periodRow(inspection, act) : null,
        inspection.columns.map((column) => folds(columnRow(column, inspection, act, plant), hidden.has(column))),
        missing.map((one) =>
          h(
            'tr',
            {class: `absent${one.role === 'output' ? ' doubtful' : ''}`},
            h('td', {class: 'column'}, t('page.records.columns.absent')),
            h('td', {class: 'cells'}, '–'),
            h('td', {class: 'use'}, quantityWords(one)),
            h('td', {class: 'unit'}, one.unit),
            h('td', {class: 'meaning'}, sentence(one.reason)),
          ),
        ),
      ),
    ),
    hidden.size > 0 && !unfolded.has(inspection.id) && unfold(hidden.size, inspection.id),
  );
}

/** @param {HTMLElement} row @param {boolean} hidden */
function folds(row, hidden) {
  if (hidden) row.classList.add('folded');
  return row;
}

/**
 * The button that shows the columns that are folded.
 * @param {number} n
 * @param {string} id   of the record
 */
function unfold(n, id) {
  const button = link(t('page.records.columns.more', {n}), () => {
    unfolded.add(id);
    button.closest('.columns-card')?.classList.add('unfolded');
    button.remove();
  });
  return button;
}

/** @param {Pick<service.MappedQuantity, 'name' | 'role'>} quantity */
const quantityWords = ({name, role}) => [symbol(name), ` · ${t(`page.records.role.${role}`)}`];

/**
 * The row for records without a column of times.
 * @param {Inspection} inspection
 * @param {RecordActions} act
 */
function periodRow({mapping}, act) {
  const field = h('input', {
    id: 'period',
    inputmode: 'decimal',
    autocomplete: 'off',
    value: mapping.time?.period ?? '',
    'aria-label': t('page.records.columns.period'),
    onchange: () => {
      const period = Number(field.value.replace(',', '.'));
      const valid = Number.isFinite(period) && period > 0;
      field.setAttribute('aria-invalid', String(!valid));
      if (valid) act.map(withTime(mapping, {column: null, unit: null, period}));
    },
  });
  return h(
    'tr',
    {class: 'doubtful'},
    h('td', {class: 'column'}, t('page.records.columns.no-time')),
    h('td', {class: 'cells'}, '–'),
    h('td', {class: 'use'}, field),
    h('td', {class: 'unit'}, 's'),
    h('td', {class: 'meaning'}, t('page.records.columns.period')),
  );
}

/**
 * @param {service.RecordColumn} column
 * @param {Inspection} inspection
 * @param {RecordActions} act
 * @param {Plant | null} plant   null: nothing can be changed yet
 */
function columnRow(column, inspection, act, plant) {
  const quantity = inspection.quantities.find((one) => one.column === column.name);
  const doubtful =
    quantity !== undefined &&
    (!quantity.certain ||
      inspection.findings.some(
        (one) => one.quantity === quantity.name && ['doubtful', 'wrong'].includes(one.severity),
      ));
  return h(
    'tr',
    {class: [column.role === 'unused' && 'unused', doubtful && 'doubtful'].filter(Boolean).join(' ')},
    h('td', {class: 'column'}, h('code', {title: column.name}, column.name)),
    h('td', {class: 'cells'}, cells(column)),
    h('td', {class: 'use'}, plant ? useChoice(column, inspection, act) : kindWords(column)),
    h('td', {class: 'unit'}, plant ? unitChoice(column, quantity, inspection, act) : column.unit),
    h('td', {class: 'meaning'}, meaning(column, quantity, inspection, plant)),
  );
}

/** @param {service.RecordColumn} column */
function cells({kind, first: [text = ''], low, high}) {
  const value = kind === 'text' || text === '' ? NaN : Number(text);
  const first = [Number.isFinite(value) ? number(value) : text];
  const texts = low === null || high === null ? first : [...first, number(low), number(high)];
  return texts.map((text, place) => [place > 0 && h('span', {class: 'soft'}, ' · '), text]);
}

/** @param {service.RecordColumn} column */
const kindWords = ({kind}) => t(`page.records.kind.${kind}`);

/**
 * @param {service.RecordColumn} column
 * @param {Inspection} inspection
 * @param {RecordActions} act
 */
function useChoice(column, inspection, act) {
  const {mapping, quantities, times} = inspection;
  const present = column.role === 'time' ? 'time' : column.target;
  /** @param {string} value @param {string} words */
  const option = (value, words) => h('option', {value, selected: value === present}, words);
  return h(
    'select',
    {
      id: `use-${column.position}`,
      'aria-label': t('page.records.columns.use-of', {column: column.name}),
      onchange: ({currentTarget}) => act.map(assigned(mapping, column.name, currentTarget.value, times?.period ?? 1)),
    },
    option('', t('page.records.columns.unused')),
    option('time', t('page.records.role.time')),
    quantities.map((one) => option(one.name, `${one.name} · ${t(`page.records.role.${one.role}`)}`)),
  );
}

/**
 * @param {service.RecordColumn} column
 * @param {service.MappedQuantity | undefined} quantity
 * @param {Inspection} inspection
 * @param {RecordActions} act
 */
function unitChoice(column, quantity, {mapping}, act) {
  if (column.role === 'time') {
    const present = mapping.time?.unit ?? 's';
    return h(
      'select',
      {
        id: `unit-${column.position}`,
        'aria-label': t('page.records.columns.unit-of', {column: column.name}),
        onchange: ({currentTarget}) => act.map(withTime(mapping, {unit: timeUnit(currentTarget.value)})),
      },
      TIME_UNITS.map((unit) => h('option', {value: unit, selected: unit === present}, timeUnitWords(unit))),
    );
  }
  if (!quantity) return column.unit;
  const {units, column_unit: present, name} = quantity;
  if (units.length === 0) return present;
  const all = units.includes(present) || !present ? units : [present, ...units];
  return h(
    'select',
    {
      id: `unit-${column.position}`,
      'aria-label': t('page.records.columns.unit-of', {column: column.name}),
      onchange: ({currentTarget}) => currentTarget.value && act.map(withUnit(mapping, name, currentTarget.value)),
    },
    !present && h('option', {value: '', selected: true}, `× ${number(quantity.factor)}`),
    all.map((unit) => h('option', {value: unit, selected: unit === present}, unit || '1')),
  );
}

/** @param {string} value */
const timeUnit = (value) => TIME_UNITS.find((unit) => unit === value) ?? null;

/** @param {string} unit */
export const timeUnitWords = (unit) => {
  const code = `page.records.time-unit.${unit}`;
  return hasWords(code) ? t(code) : unit;
};

/**
 * @param {service.RecordColumn} column
 * @param {service.MappedQuantity | undefined} quantity
 * @param {Inspection} inspection
 * @param {Plant | null} plant
 */
function meaning(column, quantity, {times}, plant) {
  if (column.role === 'time') return times ? timesWords(times) : '';
  if (!quantity) return column.note ? say(column.note) : '';
  const {name, low, high, unit, bounds, description, certain, reason} = quantity;
  const [least, most] = bounds;
  const range = low !== null && high !== null && `${number(low)} … ${number(high)}${unit ? `\u202f${unit}` : ''}`;
  const limits =
    least === null && most === null
      ? null
      : t('page.records.columns.bounds', {
          low: least === null ? '−∞' : number(least),
          high: most === null ? '∞' : number(most),
        });
  const facts = [named(itemOf(name, plant)?.description ?? description), range, limits].filter(Boolean).join(', ');
  return [facts, h('span', {class: certain ? 'soft reason' : 'reason'}, say(reason))];
}

/**
 * An input, signal or output of a plant, whose prose is in the page's language.
 * @param {string} name
 * @param {Plant | null} plant
 */
export const itemOf = (name, plant) =>
  plant ? [...plant.inputs, ...plant.signals, ...plant.outputs].find((one) => one.name === name) : undefined;

/** @param {service.RecordTimes} times */
const timesWords = ({period, jitter}) =>
  jitter >= 0.005
    ? t('page.records.columns.pace-jitter', {period: span(period), jitter: number(100 * jitter, 2)})
    : t('page.records.columns.pace', {period: span(period)});

/**
 * Show new content and keep the focus on the element with the same id.
 * @param {HTMLElement} root
 * @param {import('../../../types/dom.js').Child} content
 */
export function refill(root, content) {
  const focused = document.activeElement;
  const id = focused instanceof HTMLElement && root.contains(focused) ? focused.id : '';
  fill(root, content);
  if (id) document.getElementById(id)?.focus({preventScroll: true});
}
