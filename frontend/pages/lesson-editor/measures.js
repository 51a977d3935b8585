// What decides: numbers that are measured in the student's session, and conditions on them. All is picked from lists.

import {h} from '../../common/dom.js';
import {put} from './draft.js';
import {adding, byName, choice, numeral, removal} from './inputs.js';
import {t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */
/** @import {Condition, DraftStep, Measure} from './draft.js' */
/** @import {Form} from './inputs.js' */

/** @typedef {Exclude<Measure['kind'], 'level' | 'crosses'>} PlainKind */
/** @typedef {service.LevelInput['take'] | service.CrossesInput['side'] | PlainKind} Kind */

/**
 * The fields of all kinds of measures.
 * @typedef {Partial<
 *   Omit<service.LevelInput, 'kind'> & Omit<service.CrossesInput, 'kind'> & Omit<service.CountsInput, 'kind'> &
 *   Omit<service.SettlesInput, 'kind'> & Omit<service.FoundInput, 'kind'> & Omit<service.GainNowInput, 'kind'>
 * >} Fields
 */

/** What can be measured. @returns {[Kind, string][]} */
const kinds = () => [
  ['last', t('page.editor.take.last')],
  ['mean', t('page.editor.take.mean')],
  ['max', t('page.editor.take.max')],
  ['min', t('page.editor.take.min')],
  ['std', t('page.editor.take.std')],
  ['rms', t('page.editor.take.rms')],
  ['settles', t('page.editor.kind.settles')],
  ['above', t('page.editor.kind.above')],
  ['below', t('page.editor.kind.below')],
  ['beyond', t('page.editor.kind.beyond')],
  ['counts', t('page.editor.kind.counts')],
  ['decays', t('page.editor.kind.decays')],
  ['rises', t('page.editor.kind.rises')],
  ['found', t('page.editor.kind.found')],
  ['diverged', t('page.editor.kind.diverged')],
  ['gain', t('page.editor.kind.gain')],
];

/** @param {Measure} measure @returns {Kind} */
const kindOf = (measure) =>
  measure.kind === 'level' ? measure.take : measure.kind === 'crosses' ? measure.side : measure.kind;

/**
 * A measure of a kind, with as much of the one before as fits.
 * @param {Kind} kind
 * @param {Fields} before
 * @param {Known} known
 * @returns {Measure}
 */
function measureOf(kind, before, {columns, channels, observers}) {
  const column = before.column ?? columns[0] ?? 't';
  const {minus} = before;
  /** @type {Pick<Fields, 'minus' | 'start' | 'end'>} */
  const window = {};
  for (const key of /** @type {const} */ (['minus', 'start', 'end'])) put(window, key, before[key]);
  const level = typeof before.level === 'number' ? before.level : 0;
  const observer = observers[0]?.label ?? '';
  switch (kind) {
    case 'above':
    case 'below':
    case 'beyond':
      return {kind: 'crosses', side: kind, column, ...(minus ? {minus} : {}), level};
    case 'counts':
      return {kind, column, ...window, level};
    case 'decays':
    case 'rises':
      return {kind, column, ...window};
    case 'settles':
      return {kind, column, to: before.to ?? columns[1] ?? column, within: before.within ?? 1};
    case 'found':
      return {kind, ...(channels.length ? {channel: channels[0]} : {})};
    case 'gain':
      return {kind, observer, gain: observers[0]?.gains[0] ?? ''};
    case 'diverged':
      return {kind, observer};
    default:
      return {kind: 'level', take: kind, column, ...window};
  }
}

/** @typedef {{columns: string[], channels: string[], observers: {label: string, gains: string[]}[]}} Known */

/**
 * The numbers that the step measures.
 * @param {Form} form
 * @param {DraftStep} step
 * @param {Known} known
 */
export function measureRows(form, step, known) {
  const measures = (step.measures ??= {});
  /** @param {string} name @param {Kind} kind */
  const set = (name, kind) => {
    measures[name] = measureOf(kind, measures[name] ?? {}, known);
    form.changed();
    form.rebuild();
  };
  const next = () => {
    for (let n = 1; ; n += 1) if (!measures[`m${n}`]) return `m${n}`;
  };
  return [
    Object.entries(measures).map(([name, measure]) =>
      h(
        'div',
        {class: 'measure'},
        h('code', {}, `{${name}}`),
        choice(t('page.editor.measure', {name}), kinds(), kindOf(measure), (kind) => set(name, kind)),
        details(form, measure, known),
        h('output', {'data-measure': name}),
        removal(name, () => {
          delete measures[name];
          form.changed();
          form.rebuild();
        }),
      ),
    ),
    Object.keys(measures).length < 8 && adding(t('page.editor.add.measure'), () => set(next(), 'last')),
  ];
}

/**
 * Of what, and against what.
 * @param {Form} form
 * @param {Measure} measure
 * @param {Known} known
 */
function details(form, measure, {columns, channels, observers}) {
  /** @type {Fields} */
  const fields = measure;
  const kept = [...new Set([...columns, fields.column, fields.minus].flatMap((one) => one || []))];
  /**
   * @template {keyof Fields} K
   * @param {K} key
   * @param {Fields[K]} value
   */
  const set = (key, value) => {
    put(fields, key, value);
    form.changed();
  };
  /** @param {'column' | 'minus' | 'to'} key @param {string} name @param {boolean} none */
  const column = (key, name, none) =>
    choice(
      name,
      [...(none ? /** @type {[string, string][]} */ ([['', '0']]) : []), ...byName(kept)],
      String(fields[key] ?? ''),
      (value) => set(key, value || undefined),
    );
  /** @param {'start' | 'end' | 'within' | 'level'} key @param {string} name */
  const number = (key, name) => {
    const value = fields[key];
    return numeral(name, typeof value === 'number' ? value : null, (next) => set(key, next ?? undefined));
  };
  if (measure.kind === 'found')
    return choice(
      t('page.editor.channel'),
      [['', t('page.editor.any-channel')], ...byName(channels)],
      measure.channel ?? '',
      (value) => set('channel', value || undefined),
    );
  if (measure.kind === 'diverged' || measure.kind === 'gain') {
    const labels = byName(observers.map(({label}) => label));
    const gains = observers.find(({label}) => label === measure.observer)?.gains ?? [];
    return [
      choice(t('page.editor.observer'), labels, measure.observer, (value) => set('observer', value)),
      measure.kind === 'gain' &&
        choice(t('page.editor.gain'), byName(gains), measure.gain, (value) => set('gain', value)),
    ];
  }
  const first = column('column', t('page.editor.column'), false);
  if (measure.kind === 'settles')
    return [
      first,
      '→',
      column('to', t('page.editor.column.to'), false),
      '±',
      number('within', t('page.editor.within')),
    ];
  return [
    first,
    '−',
    column('minus', t('page.editor.column.minus'), true),
    measure.kind !== 'crosses' && [
      h('span', {class: 'soft'}, t('page.editor.window')),
      number('start', t('page.editor.window-start')),
      '…',
      number('end', t('page.editor.window-end')),
      h('span', {class: 'soft'}, 's'),
    ],
    (measure.kind === 'crosses' || measure.kind === 'counts') && [
      h('span', {}, t('page.editor.level')),
      number('level', t('page.editor.level')),
    ],
  ];
}

/**
 * Conditions under which something is right.
 * @param {Form} form
 * @param {DraftStep} step
 * @param {Condition[]} all
 */
export function conditionRows(form, step, all) {
  const names = Object.keys(step.measures ?? {});
  /** @param {number} at @param {Condition} value @param {boolean} [rebuild] */
  const set = (at, value, rebuild = false) => {
    all[at] = value;
    form.changed();
    if (rebuild) form.rebuild();
  };
  return [
    all.map((one, at) => {
      /** @type {Comparison} */
      const how = one.none
        ? 'none'
        : one.at_least !== undefined && one.at_most !== undefined
          ? 'between'
          : one.at_most !== undefined
            ? 'at_most'
            : 'at_least';
      /** @param {'at_least' | 'at_most'} bound */
      const bound = (bound) =>
        numeral(t('page.editor.limit'), one[bound], (value) => set(at, {...all[at], [bound]: value ?? 0}));
      return h(
        'div',
        {class: 'condition'},
        choice(
          t('page.editor.number'),
          names.map((name) => /** @type {[string, string]} */ ([name, `{${name}}`])),
          one.measure,
          (measure) => set(at, {...all[at], measure}),
        ),
        choice(
          t('page.editor.comparison'),
          [
            ['at_least', t('page.editor.at-least')],
            ['at_most', t('page.editor.at-most')],
            ['between', t('page.editor.between')],
            ['none', t('page.editor.never')],
          ],
          how,
          (next) => set(at, conditionOf(one, next), true),
        ),
        (how === 'at_least' || how === 'between') && bound('at_least'),
        how === 'between' && '…',
        (how === 'at_most' || how === 'between') && bound('at_most'),
        removal(one.measure, () => {
          all.splice(at, 1);
          form.changed();
          form.rebuild();
        }),
      );
    }),
    names.length > 0 &&
      all.length < 4 &&
      adding(t('page.editor.add.condition'), () => {
        all.push({measure: names[0], at_least: 0});
        form.changed();
        form.rebuild();
      }),
  ];
}

/** @typedef {'none' | 'between' | 'at_least' | 'at_most'} Comparison */

/** @param {Condition} before @param {Comparison} how @returns {Condition} */
function conditionOf({measure, at_least: least, at_most: most}, how) {
  if (how === 'none') return {measure, none: true};
  if (how === 'between') return {measure, at_least: least ?? most ?? 0, at_most: most ?? least ?? 1};
  return {measure, [how]: least ?? most ?? 0};
}
