// What comes out of a study, in tabs: curves, names confused, sensitivity, parallel axes, the table.

import {get, reason} from '../../common/api.js';
import {fill, h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';
import {brief, describe, drawCompromises, drawCurves, drawParallel, drawRoc, drawSizes} from './plots.js';
import {confusionTable, pointTable, sensitivityLine} from './result-tables.js';

/** @import {FigureBox} from '../types.js' */
/** @import * as service from '../../types/service.js' */
/** @import {Child} from '../../types/dom.js' */

const TABS = /** @type {const} */ (['curves', 'confusion', 'sensitivity', 'parallel', 'table']);

/**
 * @typedef {object} Chosen   what the cards show
 * @property {typeof TABS[number]} tab
 * @property {string} measure
 * @property {string} against
 * @property {string} curve
 * @property {string} a
 * @property {string} b
 * @property {string} roc
 * @property {string} size
 * @property {number | null} run
 */

/**
 * @param {HTMLElement} root
 * @param {{open: (run: number, live: boolean) => void}} act
 */
export function createResults(root, act) {
  /** @type {service.StudyState | null} */
  let study = null;
  /** @type {Chosen} */
  const chosen = {tab: 'curves', measure: '', against: '', curve: '', a: '', b: '', roc: '', size: '', run: null};
  /** @type {{[name: string]: number}} */
  const turns = {};
  const tabs = h('div', {class: 'study-tabs', role: 'tablist'});
  const body = h('div', {class: 'study-cards'});
  let built = '';

  /** Choose what is known and most wanted, where nothing is chosen yet. */
  function settle() {
    if (!study) return;
    const {measures, factors} = study;
    /** @param {string} now @param {readonly RegExp[]} wanted @param {string} [other] */
    const pick = (now, wanted, other = '') =>
      measures.includes(now)
        ? now
        : (wanted.map((one) => measures.find((name) => one.test(name) && name !== other)).find(Boolean) ??
          measures.find((name) => name !== other) ??
          '');
    chosen.measure = pick(chosen.measure, [/^delay\.detector/, /^rmse\..*theta/, /^rmse/]);
    chosen.a = pick(chosen.a, [/^rmse\..*theta/, /^rmse/, /^size_error\.detector/]);
    chosen.b = pick(chosen.b, [/^delay\.detector/, /^peak/, /^rmse/], chosen.a);
    if (!factors.includes(chosen.against)) chosen.against = factors[0] ?? '';
    if (!factors.includes(chosen.curve) || chosen.curve === chosen.against)
      chosen.curve = factors.find((name) => name !== chosen.against) ?? '';
    if (!study.sizes.includes(chosen.size)) chosen.size = study.sizes[0] ?? '';
    if (!factors.includes(chosen.roc))
      chosen.roc = factors.find((name) => name.endsWith('false_alarms')) ?? factors[0] ?? '';
  }

  /**
   * @param {string} label @param {readonly string[]} names @param {string} now @param {(name: string) => void} set
   * @param {string} [none]   the words for none
   */
  function choice(label, names, now, set, none) {
    const field = h(
      'select',
      {
        'aria-label': label,
        onchange: () => {
          set(field.value);
          settle();
          draw();
        },
      },
      none !== undefined && h('option', {value: '', selected: now === ''}, none),
      names.map((name) => h('option', {value: name, selected: name === now}, name)),
    );
    return field;
  }

  /**
   * A card whose figure is fetched and drawn.
   * @param {string} name @param {string} heading @param {readonly Child[]} choices
   * @param {(plot: FigureBox['plot'], under: HTMLElement) => Promise<void>} paint
   */
  function card(name, heading, choices, paint) {
    /** @type {FigureBox['plot']} */
    const plot = h('div', {class: 'plot', role: 'group', 'aria-label': heading});
    const under = h('div', {class: 'study-under'});
    const shell = h(
      'article',
      {class: `card study-card study-${name}`, 'data-card': name},
      h('header', {}, h('h2', {}, heading), h('div', {class: 'study-choices'}, choices)),
      plot,
      under,
    );
    turns[name] = (turns[name] ?? 0) + 1;
    const turn = turns[name];
    queueMicrotask(async () => {
      try {
        await paint(plot, under);
        if (turn === turns[name]) shell.dataset.drawn = '';
      } catch (error) {
        if (turn === turns[name]) fill(under, h('p', {class: 'alarm'}, reason(error).message));
      }
    });
    return shell;
  }

  /**
   * What is computed from the runs.
   * @template T
   * @param {string} path
   * @param {{[name: string]: string}} query
   * @returns {Promise<T>}
   */
  const ask = (path, query) => {
    const known = Object.fromEntries(Object.entries(query).filter(([, value]) => value !== ''));
    return get(`${study?.links.self}/${path}?${new URLSearchParams(known)}`);
  };

  /** @param {number} run */
  const open = (run) => act.open(run, false);

  /** @returns {Child[]} */
  function curves() {
    if (!study) return [];
    const {measures, factors} = study;
    const {measure, against, curve, a, b, roc, size} = chosen;
    const judged = measures.some((name) => name === 'alarms.detector');
    const {sizes} = study;
    return [
      factors.length > 0 &&
        card(
          'spread',
          t('page.studies.spread'),
          [
            choice(t('page.studies.measure'), measures, measure, (name) => (chosen.measure = name)),
            h('span', {class: 'soft'}, t('page.studies.against')),
            choice(t('page.studies.against'), factors, against, (name) => (chosen.against = name)),
            factors.length > 1 &&
              choice(
                t('page.studies.curve'),
                factors.filter((name) => name !== against),
                curve,
                (name) => (chosen.curve = name),
              ),
          ],
          async (plot, under) => {
            /** @type {service.Curves} */
            const {points} = await ask('curves', {measure, against, curve});
            await drawCurves(plot, points, measure, against, open);
            const rate = points.some((point) => point.rate);
            fill(under, h('p', {class: 'soft'}, rate ? t('page.studies.spread.rate') : t('page.studies.spread.band')));
          },
        ),
      measures.length > 1 &&
        card(
          'pareto',
          t('page.studies.pareto'),
          [
            choice('a', measures, a, (name) => (chosen.a = name)),
            h('span', {class: 'soft'}, t('page.studies.against')),
            choice('b', measures, b, (name) => (chosen.b = name)),
          ],
          async (plot, under) => {
            /** @type {service.Compromises} */
            const {points} = await ask('pareto', {a, b});
            await drawCompromises(plot, points, a, b, (run) => {
              const point = points.find((one) => one.run === run);
              if (point) fill(under, compromise(point, a, b));
            });
            const lacking = (study?.points ?? 0) - points.length;
            fill(
              under,
              h('p', {class: 'soft'}, t('page.studies.pareto.hint')),
              lacking > 0 && h('p', {class: 'soft'}, t('page.studies.pareto.lacking', {n: lacking})),
            );
          },
        ),
      judged &&
        size !== '' &&
        card(
          'sizes',
          t('page.studies.sizes'),
          [choice(t('page.studies.against'), sizes, size, (name) => (chosen.size = name))],
          async (plot, under) => {
            /** @type {service.FoundBySize} */
            const {channels, share} = await ask('sizes', {against: size});
            await drawSizes(plot, channels, size, open);
            fill(
              under,
              channels.map(({channel, smallest}) => {
                const found = {channel, percent: Math.round(100 * share)};
                return h(
                  'p',
                  {},
                  smallest === null
                    ? t('page.studies.sizes.never', found)
                    : t('page.studies.sizes.from', {...found, size: brief(smallest)}),
                );
              }),
              h('p', {class: 'soft'}, t('page.studies.sizes.hint')),
            );
          },
        ),
      judged &&
        factors.length > 0 &&
        card(
          'roc',
          t('page.studies.roc'),
          [choice(t('page.studies.against'), factors, roc, (name) => (chosen.roc = name))],
          async (plot, under) => {
            /** @type {service.Roc} */
            const {points} = await ask('roc', {against: roc});
            await drawRoc(plot, points);
            fill(
              under,
              h(
                'p',
                {class: 'soft'},
                points.some((one) => one.false.of) ? zero(points) : t('page.studies.roc.no-healthy'),
              ),
            );
          },
        ),
    ];
  }

  /** What the false alarms say together. @param {readonly service.RocPointAnswer[]} points */
  function zero(points) {
    const all = points.reduce((sum, one) => sum + one.false.of, 0);
    const raised = points.reduce((sum, one) => sum + one.false.count, 0);
    return raised === 0
      ? t('page.studies.roc.none', {of: all, percent: Number((100 * (1 - 0.025 ** (1 / all))).toPrecision(2))})
      : t('page.studies.roc.some', {count: raised, of: all});
  }

  /** @param {service.CompromiseAnswer} point @param {string} a @param {string} b */
  function compromise(point, a, b) {
    return h(
      'p',
      {class: 'study-point'},
      h('b', {}, describe(point.values)),
      ` ${a} ${brief(point.a)}, ${b} ${brief(point.b)} `,
      h('button', {type: 'button', class: 'link', onclick: () => act.open(point.run, true)}, t('page.studies.use')),
      ' · ',
      h('button', {type: 'button', class: 'link', onclick: () => act.open(point.run, false)}, t('page.studies.open')),
    );
  }

  /** @returns {Child[]} */
  function confusion() {
    const shell = h('article', {class: 'card study-card study-wide'});
    ask('confusion', {}).then(
      (/** @type {service.Confusion} */ {counts}) => fill(shell, confusionTable(counts)),
      (error) => fill(shell, h('p', {class: 'soft'}, reason(error).message)),
    );
    return [shell];
  }

  /** @returns {Child[]} */
  function sensitivity() {
    if (!study) return [];
    const {measure} = chosen;
    const list = h('div', {class: 'study-bars'});
    ask('sensitivity', {measure}).then(
      (/** @type {service.Sensitivities} */ {factors}) => fill(list, factors.map(sensitivityLine)),
      (error) => fill(list, h('p', {class: 'alarm'}, reason(error).message)),
    );
    return [
      h(
        'article',
        {class: 'card study-card study-wide'},
        h(
          'header',
          {},
          h('h2', {}, t('page.studies.tab.sensitivity')),
          h(
            'div',
            {class: 'study-choices'},
            choice(t('page.studies.measure'), study.measures, measure, (name) => (chosen.measure = name)),
          ),
        ),
        list,
        h('p', {class: 'soft'}, t('page.studies.sensitivity.hint')),
      ),
    ];
  }

  /** @returns {Child[]} */
  function parallel() {
    const names = study?.factors ?? [];
    return [
      card('parallel', t('page.studies.tab.parallel'), [], async (plot, under) => {
        /** @type {service.PointAnswers} */
        const table = await ask('points', {});
        await drawParallel(plot, table, names, open);
        fill(under, h('p', {class: 'soft'}, t('page.studies.parallel.hint')));
      }),
    ];
  }

  /** @returns {Child[]} */
  function table() {
    const shell = h('article', {
      class: 'card study-card study-wide study-scroll',
      tabindex: 0,
      role: 'region',
      'aria-label': t('page.studies.tab.table'),
    });
    ask('points', {}).then(
      (/** @type {service.PointAnswers} */ found) => fill(shell, pointTable(found, study?.factors ?? [], open)),
      (error) => fill(shell, h('p', {class: 'alarm'}, reason(error).message)),
    );
    return [shell];
  }

  function draw() {
    const parts = {curves, confusion, sensitivity, parallel, table};
    fill(
      tabs,
      TABS.map((tab) =>
        h(
          'button',
          {
            type: 'button',
            role: 'tab',
            'aria-selected': String(tab === chosen.tab),
            onclick: () => {
              chosen.tab = tab;
              draw();
            },
          },
          t(`page.studies.tab.${tab}`),
        ),
      ),
    );
    body.className = `study-cards study-of-${chosen.tab}`;
    fill(body, study?.measures.length ? parts[chosen.tab]() : h('p', {class: 'soft'}, t('page.studies.waiting')));
  }

  addEventListener('theme', () => built && draw());

  return {
    /** Show a study as it is now; nothing is drawn anew if no run has come. @param {service.StudyState} state */
    show(state) {
      const mark = `${state.id} ${state.done} ${state.measures.length}`;
      study = state;
      if (mark === built) return;
      built = mark;
      settle();
      if (!root.contains(tabs)) fill(root, tabs, body);
      draw();
    },
    draw,
  };
}
