// Between the experiment and its figures: the detector's findings, and which observer found which fault how fast; with
// the numbers
// behind it folded away.

import {fill, h, number} from '../../common/dom.js';
import {alarmFrom} from '../../diagnosis/alarms.js';
import {line, summarySentence} from '../../diagnosis/finding-line.js';
import {findings, stateOf} from '../../diagnosis/findings.js';
import {chip as coloured, took} from '../../widgets/controls.js';
import {colourOf, repeats} from '../../widgets/line-style.js';
import {trajectory, visible} from '../../diagnosis/detectability.js';
import {amount} from '../../diagnosis/fault-size.js';
import {certainty} from '../../diagnosis/confidence.js';
import {called, spoken} from '../../common/names.js';
import {errors, settling} from './error-tables.js';
import {asSentence, say, t} from '../../i18n/words.js';

/** @import {Child} from '../../types/dom.js' */
/** @import {Comparison, ComparisonRow, Diagnosis, ObserverDiagnosis} from '../types.js' */
/** @import {Plant, Run, RunState, RunStore} from '../types.js' */
/** @import * as service from '../../types/service.js' */

/** @typedef {'found' | 'missed' | 'false_alarms' | 'isolation_errors' | 'delay' | 'cost'} Measure */

/** @param {number} place */
const chip = (place) => coloured(colourOf(place), repeats(place));

/** @param {HTMLElement} root @param {RunStore} store */
export function mountVerdicts(root, store) {
  store.subscribe((state, before) => {
    if (state.run === before.run && state.plant === before.plant) return;
    const {run, plant} = state;
    const {diagnosis, comparison, facts} = run?.summary ?? {};
    root.hidden = !diagnosis && !comparison;
    if (root.hidden || !run || !plant) return fill(root);
    return fill(
      root,
      diagnosis && facts && card(t('page.diagnosis.title'), detector(run, plant, facts, diagnosis)),
      comparison &&
        comparison.observers.length > 0 &&
        card(t('page.runs.who-found'), compared(run, diagnosis, comparison, plant)),
    );
  });
}

/** @param {Child} title @param {...Child} body */
const card = (title, ...body) => h('section', {class: 'card'}, h('h2', {}, title), ...body);
/** @param {Child} title @param {...Child} body */
const fold = (title, ...body) => h('details', {class: 'more'}, h('summary', {}, title), ...body);

/**
 * The summary, the findings, and what is detectable: as on the live page, at the end of the run.
 * @param {Run} run
 * @param {Plant} plant
 * @param {service.Facts} facts
 * @param {Diagnosis} diagnosis
 */
function detector({spec}, plant, facts, {detector: diagnosis}) {
  const state = {...stateOf(facts), plant, spec, diagnosis: diagnosis, t: spec.horizon};
  const app = {state};
  const all = findings(state);
  return [
    h('p', {class: 'verdict'}, summarySentence(state.facts.summary, app)),
    h(
      'div',
      {class: 'side-by-side'},
      all.map((one) => line(one, app)),
    ),
    diagnosis.calibration && fold(t('page.diagnosis.detectability'), visible(app), trajectory(app)),
    diagnosis.calibration &&
      fold(
        t('page.diagnosis.certainty'),
        h(
          'div',
          {class: 'small'},
          certainty(state).map((paragraph) => h('p', {}, paragraph)),
        ),
      ),
  ];
}

/** @type {Measure[]} */
const COUNTS = ['found', 'missed', 'false_alarms', 'isolation_errors'];
/** @type {Measure[]} */
const MEASURES = [...COUNTS, 'delay', 'cost'];

/**
 * Who found what: the detector and each observer's own estimates; what these say, and how far they were off.
 * @param {Run} run
 * @param {Diagnosis | null | undefined} diagnosis
 * @param {Comparison} comparison
 * @param {Plant} plant
 */
function compared(run, diagnosis, {windows, observers: rows}, plant) {
  const observers = run.summary?.observers ?? [];
  /** @param {string} label */
  const place = (label) => observers.findIndex((one) => one.label === label);
  const judged = rows.filter((row) => row.found !== null);
  const head = h(
    'tr',
    {},
    h('td'),
    MEASURES.map((name) =>
      h('th', {scope: 'col', title: t(`page.runs.measure.${name}.hint`)}, t(`page.runs.measure.${name}`)),
    ),
  );
  /** @param {ComparisonRow} row @param {Measure} name */
  const cell = (row, name) =>
    h(
      'td',
      {
        class: name !== 'found' && COUNTS.includes(name) && Number(row[name]) > 0 ? 'alarm' : null,
        title: name === 'found' && row.faults ? outcomes(row.faults, plant) : null,
      },
      name === 'delay' && row.delay !== null ? took(row.delay) : number(row[name], 3),
    );
  /** @param {ComparisonRow} row */
  const name = (row) =>
    place(row.label) < 0
      ? [h('span', {class: 'flag', 'aria-hidden': 'true'}), h('b', {}, t('page.runs.detector'))]
      : [chip(place(row.label)), row.label];
  const order = [...rows].sort((a, b) => place(a.label) - place(b.label));
  const table = h(
    'table',
    {class: 'measures'},
    h('thead', {}, head),
    h(
      'tbody',
      {},
      order.map((row) =>
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, name(row)),
          MEASURES.map((one) => cell(row, one)),
        ),
      ),
    ),
  );
  return [
    judged.length > 0 ? h('p', {class: 'soft'}, t('page.runs.who-found.hint')) : null,
    h('div', {class: 'wide', tabindex: 0}, table),
    diagnosis &&
      diagnosis.observers.length > 0 &&
      fold(
        t('page.runs.own-estimates'),
        h(
          'ul',
          {class: 'own'},
          diagnosis.observers.map((one) => own(one, place(one.observer), plant)),
        ),
      ),
    fold(t('page.runs.by-window'), h('div', {class: 'wide', tabindex: 0}, errors(windows, rows, chip, place, plant))),
    rows.some((row) => row.steps.length) &&
      fold(t('page.runs.settling-times'), h('div', {class: 'wide', tabindex: 0}, settling(rows, chip, place))),
  ];
}

/**
 * The outcome for each fault, one per line.
 * @param {NonNullable<ComparisonRow['faults']>} faults
 * @param {Plant} plant
 */
const outcomes = (faults, plant) =>
  faults
    .map(({name, onset, outcome, delay, alternative}) => {
      const words = t(`page.runs.outcome.${outcome}`, {
        fault: called(name, plant),
        onset,
        delay: delay === null ? '–' : took(delay),
      });
      return alternative ? t('page.runs.outcome.alternative', {outcome: words}) : words;
    })
    .join('\n');

/**
 * The results of the tests on an observer's own estimates: the alarms that are on at the end, else the last ones.
 * @param {ObserverDiagnosis} diagnosis
 * @param {number} place
 * @param {Plant} plant
 */
function own({observer, alarms, note, calibration, resolution}, place, plant) {
  const raised = alarms.map(alarmFrom);
  const on = raised.filter((alarm) => alarm.over === null);
  const lines = (on.length ? on : raised.slice(-3)).map((alarm) => {
    const channel = plant.channels.find((one) => one.name === alarm.subject);
    const fault = {
      fault: called(alarm.subject, plant),
      size: amount(alarm, channel),
      t: `${number(alarm.onset, 3)} s`,
    };
    return alarm.over === null
      ? t('page.runs.own-estimates.fault', fault)
      : t('page.runs.own-estimates.fault-over', fault);
  });
  const lost = resolution.filter((one) => !one.resolvable);
  const limit =
    calibration &&
    Object.entries(calibration.thresholds)
      .map(([test, value]) => `${t(`page.runs.test.${test}`)} ${number(value, 3)}`)
      .join(', ');
  return h(
    'li',
    {},
    chip(place),
    h('b', {}, observer),
    ' ',
    note
      ? say(note)
      : lines.length
        ? lines.reduce((first, second) => t('page.text.semicolon', {first, second}))
        : t('page.runs.own-estimates.quiet'),
    limit && h('span', {class: 'soft'}, ` ${t('page.runs.thresholds', {limits: limit})}`),
    lost.map((one) => h('span', {class: 'soft'}, ` ${asSentence(spoken(one.text, plant))}`)),
  );
}
