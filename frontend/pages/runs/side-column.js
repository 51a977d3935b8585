// Beside the figures: the comparison of the observers, their assumptions, the source's errata, downloads.

import {fill, h, number, symbol} from '../../common/dom.js';
import {downloads} from './downloads.js';
import {chip as coloured} from '../../widgets/controls.js';
import {colourOf, repeats} from '../../widgets/line-style.js';
import {assumptions} from '../../widgets/checks.js';
import {say, t} from '../../i18n/words.js';

/** @import {ObserverSummary, Plant, RunStore, RunSummary} from '../types.js' */
/** @import {Child} from '../../types/dom.js' */
/** @import * as service from '../../types/service.js' */

/** @param {number} place */
const chip = (place) => coloured(colourOf(place), repeats(place));
/** @param {Child} title @param {...Child} body */
const card = (title, ...body) => h('section', {class: 'card'}, h('h2', {}, title), ...body);

/** @param {HTMLElement} root @param {RunStore} store */
export function mountSide(root, store) {
  store.subscribe((state, before) => {
    if (state.spec === before.spec && state.run === before.run) return;
    const {spec, run, plant} = state;
    if (!spec) return fill(root);
    const observers = run?.summary?.observers ?? [];
    return fill(
      root,
      run?.summary && troubles(run.summary),
      observers.length > 0 && card(t('page.comparison.title'), comparison(observers, plant)),
      observers.some((one) => one.checks.length) && card(t('page.observers.assumptions'), observers.map(assumptions)),
      ownNotes(run?.spec ?? spec),
      spec.errata.length > 0 &&
        card(
          t('page.runs.errata'),
          h(
            'ul',
            {class: 'errata'},
            spec.errata.map((item) => h('li', {}, item)),
          ),
        ),
      run && card(t('page.runs.downloads'), downloads({...state, run})),
    );
  });
}

/**
 * The notes and bookmarks that were set on the time of the run.
 * @param {Pick<service.Experiment, 'notes'>} spec
 */
function ownNotes({notes}) {
  if (notes.length === 0) return null;
  const lines = [...notes]
    .sort((a, b) => a.t - b.t)
    .map(({t: at, text}) =>
      h('li', {}, text ? t('page.notes.line', {t: number(at, 6), text}) : t('page.notes.bookmark', {t: number(at, 6)})),
    );
  return card(t('page.notes.label'), h('ul', {class: 'own-notes'}, lines));
}

/**
 * Notes of the run, the divergence of the plant itself, and the accuracy of the integration.
 * @param {RunSummary} summary
 */
function troubles({diverged, notes, accuracy}) {
  const lines = [
    ...(diverged
      ? [
          h(
            'p',
            {class: 'alarm'},
            t('page.runs.plant-diverged', {t: number(diverged.time), cause: say(diverged.cause)}),
          ),
        ]
      : []),
    ...notes.map((note) => h('p', {}, say(note))),
    ...(accuracy ? [h('p', {}, t('page.runs.accuracy', rounded(accuracy)))] : []),
  ];
  return lines.length ? card(t('page.runs.notes'), lines) : null;
}

/**
 * Estimated errors with one digit.
 * @param {{plant: number, observers: number}} accuracy
 */
function rounded({plant, observers}) {
  return {plant: plant.toPrecision(1), observers: observers.toPrecision(1)};
}

/**
 * One column an observer, one row a measure: RMSE of each state, θ̂ at the end, settling after each step of a fault.
 * @param {ObserverSummary[]} observers
 * @param {Plant | null} plant
 */
function comparison(observers, plant) {
  const many = observers.length > 2;
  const head = h(
    'tr',
    {},
    h('td'),
    observers.map((one, place) =>
      h(
        'th',
        {scope: 'col'},
        chip(place),
        one.label,
        one.diverged &&
          h(
            'small',
            {class: 'alarm', title: say(one.diverged.cause)},
            t('page.runs.diverged', {t: number(one.diverged.time)}),
          ),
      ),
    ),
  );
  const units = new Map([...(plant?.states ?? []), ...(plant?.channels ?? [])].map((item) => [item.name, item.unit]));
  /**
   * @param {string} name
   * @param {string} title
   * @param {string | null} note
   * @param {Child[]} cells
   */
  const row = (name, title, note, cells) =>
    h(
      'tr',
      {},
      h(
        'th',
        {scope: 'row', title: [title, units.get(name)].filter(Boolean).join(', ')},
        symbol(name),
        note && h('small', {}, note),
      ),
      cells.map((cell) => h('td', {}, cell)),
    );
  /** @param {(one: ObserverSummary) => object | undefined} pick */
  const named = (pick) => [...new Set(observers.flatMap((one) => Object.keys(pick(one) ?? {})))];
  /**
   * @param {Child} title
   * @param {string | null} hint
   * @param {Child[]} rows
   */
  const group = (title, hint, rows) =>
    rows.length
      ? h(
          'tbody',
          {},
          h('tr', {class: 'group'}, h('th', {colspan: observers.length + 1, scope: 'rowgroup', title: hint}, title)),
          rows,
        )
      : null;
  const rmse = named((one) => one.rmse).map((state) =>
    row(
      state,
      t('page.runs.rmse.hint'),
      null,
      observers.map((one) => number(one.rmse[state], 3)),
    ),
  );
  const final = named((one) => one.theta).map((channel) => {
    const truth = number(observers.find((one) => one.theta?.[channel])?.theta[channel].truth);
    return row(
      channel,
      t('page.runs.truth-is', {truth}),
      many ? truth : t('page.runs.truth', {truth}),
      observers.map((one) => number(one.theta?.[channel]?.estimate, many ? 3 : 4)),
    );
  });
  const steps = (observers.find((one) => one.settling?.length)?.settling ?? []).map(({channel, at}) =>
    row(
      channel,
      t('page.runs.settled.hint'),
      `${at} s`,
      observers.map((one) => settled(one.settling?.find((entry) => entry.channel === channel && entry.at === at))),
    ),
  );
  return h(
    'div',
    {class: 'wide', tabindex: 0},
    h(
      'table',
      {class: many ? 'many' : null},
      h('thead', {}, head),
      group(t('page.runs.rmse'), t('page.runs.rmse.hint'), rmse),
      group([h('span', {class: 'math'}, h('i', {class: 'hat'}, 'θ')), ` ${t('page.runs.at-end')}`], null, final),
      group(t('page.runs.settled'), t('page.runs.settled.hint'), steps),
    ),
  );
}

/** @param {service.Settling | undefined} entry */
function settled(entry) {
  if (!entry) return '–';
  if (entry.time !== null) return number(entry.time, 3);
  return entry.reached === null ? t('page.runs.never') : `(${number(entry.reached, 3)})`;
}
