// What decides: numbers that are measured in the student's session, and conditions on them. All is picked from lists.

import {h} from '../../common/dom.js';
import {adding, choice, numeral, removal} from './inputs.js';
import {t} from '../../i18n/words.js';

/** @import {Draft} from './draft.js' */
/** @import {Form} from './inputs.js' */

/** What can be measured. @returns {[string, string][]} */
const kinds = () => [
  ['last', t('page.editor.take.last')],
  ['mean', t('page.editor.take.mean')],
  ['max', t('page.editor.take.max')],
  ['min', t('page.editor.take.min')],
  ['std', t('page.editor.take.std')],
  ['settles', t('page.editor.kind.settles')],
  ['above', t('page.editor.kind.above')],
  ['below', t('page.editor.kind.below')],
  ['beyond', t('page.editor.kind.beyond')],
  ['counts', t('page.editor.kind.counts')],
  ['found', t('page.editor.kind.found')],
  ['diverged', t('page.editor.kind.diverged')],
  ['gain', t('page.editor.kind.gain')],
];

/** @param {Draft} measure */
const kindOf = (measure) =>
  measure.kind === 'level' ? measure.take : measure.kind === 'crosses' ? measure.side : measure.kind;

/**
 * A measure of a kind, with as much of the one before as fits.
 * @param {string} kind
 * @param {Draft} before
 * @param {Known} known
 * @returns {Draft}
 */
function measureOf(kind, before, {columns, channels, observers}) {
  const column = before.column ?? columns[0] ?? 't';
  const minus = Object.fromEntries(
    ['minus', 'start', 'end'].filter((key) => before[key] !== undefined).map((key) => [key, before[key]]),
  );
  const level = typeof before.level === 'number' ? before.level : 0;
  if (['last', 'mean', 'max', 'min', 'std'].includes(kind)) return {kind: 'level', take: kind, column, ...minus};
  if (['above', 'below', 'beyond'].includes(kind))
    return {kind: 'crosses', side: kind, column, ...(before.minus ? {minus: before.minus} : {}), level};
  if (kind === 'counts') return {kind, column, ...minus, level};
  if (kind === 'settles') return {kind, column, to: before.to ?? columns[1] ?? column, within: before.within ?? 1};
  if (kind === 'found') return {kind, ...(channels.length ? {channel: channels[0]} : {})};
  if (kind === 'gain') return {kind, observer: observers[0]?.label ?? '', gain: observers[0]?.gains[0] ?? ''};
  return {kind, observer: observers[0]?.label ?? ''};
}

/** @typedef {{columns: string[], channels: string[], observers: {label: string, gains: string[]}[]}} Known */

/**
 * The numbers that the step measures.
 * @param {Form} form
 * @param {Draft} step
 * @param {Known} known
 */
export function measureRows(form, step, known) {
  step.measures ??= {};
  /** @param {string} name @param {string} kind */
  const set = (name, kind) => {
    step.measures[name] = measureOf(kind, step.measures[name] ?? {}, known);
    form.changed();
    form.rebuild();
  };
  const next = () => {
    for (let n = 1; ; n += 1) if (!step.measures[`m${n}`]) return `m${n}`;
  };
  return [
    Object.entries(step.measures).map(([name, measure]) =>
      h(
        'div',
        {class: 'measure'},
        h('code', {}, `{${name}}`),
        choice(t('page.editor.measure', {name}), kinds(), kindOf(measure), (kind) => set(name, kind)),
        details(form, measure, known),
        h('output', {'data-measure': name}),
        removal(name, () => {
          delete step.measures[name];
          form.changed();
          form.rebuild();
        }),
      ),
    ),
    Object.keys(step.measures).length < 8 && adding(t('page.editor.add.measure'), () => set(next(), 'last')),
  ];
}

/**
 * Of what, and against what.
 * @param {Form} form
 * @param {Draft} measure
 * @param {Known} known
 */
function details(form, measure, {columns, channels, observers}) {
  const kept = [...new Set([...columns, measure.column, measure.minus].filter(Boolean))];
  /** @param {string} key @param {unknown} value */
  const set = (key, value) => {
    if (value === '' || value === null) delete measure[key];
    else measure[key] = value;
    form.changed();
  };
  /** @param {string} key @param {string} name @param {boolean} none */
  const column = (key, name, none) =>
    choice(
      name,
      [
        ...(none ? /** @type {[string, string][]} */ ([['', '0']]) : []),
        ...kept.map((one) => /** @type {[string, string]} */ ([one, one])),
      ],
      String(measure[key] ?? ''),
      (value) => set(key, value),
    );
  /** @param {string} key @param {string} name */
  const number = (key, name) => numeral(name, measure[key], (value) => set(key, value));
  if (measure.kind === 'found')
    return choice(
      t('page.editor.channel'),
      [['', t('page.editor.any-channel')], ...channels.map((one) => /** @type {[string, string]} */ ([one, one]))],
      measure.channel ?? '',
      (value) => set('channel', value),
    );
  if (measure.kind === 'diverged' || measure.kind === 'gain') {
    const labels = observers.map(({label}) => /** @type {[string, string]} */ ([label, label]));
    const gains = observers.find(({label}) => label === measure.observer)?.gains ?? [];
    return [
      choice(t('page.editor.observer'), labels, measure.observer, (value) => set('observer', value)),
      measure.kind === 'gain' &&
        choice(
          t('page.editor.gain'),
          gains.map((one) => /** @type {[string, string]} */ ([one, one])),
          measure.gain,
          (value) => set('gain', value),
        ),
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
 * @param {Draft} step
 * @param {Draft} owner      whose conditions they are, under `key`
 * @param {string} key
 */
export function conditionRows(form, step, owner, key) {
  const names = Object.keys(step.measures ?? {});
  /** @type {Draft[]} */
  const all = (owner[key] ??= []);
  /** @param {number} at @param {Draft} value @param {boolean} [rebuild] */
  const set = (at, value, rebuild = false) => {
    all[at] = value;
    form.changed();
    if (rebuild) form.rebuild();
  };
  return [
    all.map((one, at) => {
      const how = one.none
        ? 'none'
        : one.at_least !== undefined && one.at_most !== undefined
          ? 'between'
          : one.at_most !== undefined
            ? 'at_most'
            : 'at_least';
      /** @param {string} bound */
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

/** @param {Draft} before @param {string} how @returns {Draft} */
function conditionOf({measure, at_least: least, at_most: most}, how) {
  if (how === 'none') return {measure, none: true};
  if (how === 'between') return {measure, at_least: least ?? most ?? 0, at_most: most ?? least ?? 1};
  return {measure, [how]: least ?? most ?? 0};
}
