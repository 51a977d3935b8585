// Between the experiment and its figures: what the detector found, and who found what how fast; with the numbers behind it folded away.

import {fill, h, number} from '../../common/dom.js';
import {language} from '../../i18n/language.js';
import {alarmFrom} from '../../diagnosis/alarms.js';
import {line, spell} from '../../diagnosis/finding-line.js';
import {findings, sentence} from '../../diagnosis/findings.js';
import {took} from '../../widgets/controls.js';
import {trajectory, visible} from '../../diagnosis/detectability.js';
import {amount} from '../../diagnosis/fault-size.js';
import {certainty} from '../../diagnosis/confidence.js';
import {faultsAt} from '../../live/state/reduce.js';
import * as words from '../../i18n/live.js';
import {called, capital, spoken} from '../../common/names.js';
import {text} from '../../i18n/pages.js';
import {errors, settling} from './error-tables.js';

const live = words[language()];
const chip = (place) => h('span', {class: 'chip', style: `--c:var(--o${place % 6})`});

export function mountVerdicts(root, store) {
  store.subscribe((state, before) => {
    if (state.run === before.run && state.plant === before.plant) return;
    const {diagnosis, comparison} = state.run?.summary ?? {};
    root.hidden = !diagnosis && !comparison;
    if (root.hidden || !state.plant) return fill(root);
    return fill(
      root,
      diagnosis && card(text.diagnosis, detector(state, diagnosis)),
      comparison?.observers.length > 0 && card(text.whoFound, compared(state.run, diagnosis, comparison, state.plant)),
    );
  });
}

const card = (title, ...body) => h('section', {class: 'card'}, h('h2', {}, title), ...body);
const fold = (title, ...body) => h('details', {class: 'more'}, h('summary', {}, title), ...body);

/** The sentence, the findings, and what can be seen at all: the words of the live page, at the end of the run. */
function detector({run, plant}, {detector: told}) {
  const {spec} = run;
  const faults = faultsAt(spec, spec.horizon);
  const state = {plant, spec, faults, alarms: told.alarms.map(alarmFrom), diagnosis: told, t: spec.horizon};
  const app = {state, text: live};
  const found = findings(state);
  return [
    h('p', {class: 'verdict'}, capital(spell(sentence(found, state), app))),
    h(
      'div',
      {class: 'side-by-side'},
      found.map((one) => line(one, app)),
    ),
    told.calibration && fold(text.canSee, visible(app), trajectory(app)),
    told.calibration &&
      fold(
        text.howSure,
        h(
          'div',
          {class: 'small'},
          certainty(state, live).map((said) => h('p', {}, said)),
        ),
      ),
  ];
}

const COUNTS = ['found', 'missed', 'false_alarms', 'isolation_errors'];

/** Who found what: the detector and each observer's own estimates; what these say, and how far they were off. */
function compared(run, diagnosis, {windows, observers: rows}, plant) {
  const {observers} = run.summary;
  const place = (label) => observers.findIndex((one) => one.label === label);
  const judged = rows.filter((row) => row.found !== null);
  const head = h(
    'tr',
    {},
    h('td'),
    [...COUNTS, 'delay', 'cost'].map((name) =>
      h('th', {scope: 'col', title: text.measures[name][1]}, text.measures[name][0]),
    ),
  );
  const cell = (row, name) =>
    h(
      'td',
      {
        class: name !== 'found' && COUNTS.includes(name) && row[name] > 0 ? 'alarm' : null,
        title: name === 'found' && row.faults ? told(row.faults, plant) : null,
      },
      row[name] === null ? '–' : name === 'delay' ? took(row[name]) : number(row[name], 3),
    );
  const name = (row) =>
    place(row.label) < 0
      ? [h('span', {class: 'flag', 'aria-hidden': 'true'}), h('b', {}, text.detector)]
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
          [...COUNTS, 'delay', 'cost'].map((one) => cell(row, one)),
        ),
      ),
    ),
  );
  return [
    judged.length > 0 ? h('p', {class: 'soft'}, text.whoFoundText) : null,
    h('div', {class: 'wide', tabindex: 0}, table),
    diagnosis?.observers.length > 0 &&
      fold(
        text.ownEstimates,
        h(
          'ul',
          {class: 'own'},
          diagnosis.observers.map((one) => own(one, place(one.observer), plant)),
        ),
      ),
    fold(text.byWindow, h('div', {class: 'wide', tabindex: 0}, errors(windows, rows, chip, place, plant))),
    rows.some((row) => row.steps.length) &&
      fold(text.settlingTimes, h('div', {class: 'wide', tabindex: 0}, settling(rows, chip, place))),
  ];
}

/** What became of each fault, one a line. */
const told = (faults, plant) =>
  faults
    .map(
      (one) =>
        `${called(one.name, plant, live)}, ${one.onset} s: ${text.outcomes[one.outcome]}${one.delay === null ? '' : ` ${took(one.delay)}`}${one.alternative ? `, ${text.asAlternative}` : ''}`,
    )
    .join('\n');

/** What the tests on one observer's own estimates say: what is on at the end, else the last that were. */
function own({observer, alarms, note, calibration, resolution}, place, plant) {
  const raised = alarms.map(alarmFrom);
  const on = raised.filter((alarm) => alarm.over === null);
  const said = (on.length ? on : raised.slice(-3)).map((alarm) => {
    const channel = plant.channels.find((one) => one.name === alarm.subject);
    return `${called(alarm.subject, plant, live)} ${amount(alarm, channel)}, ${live.since(`${number(alarm.onset, 3)} s`)}${alarm.over === null ? '' : `, ${live.cleared}`}`;
  });
  const lost = resolution.filter((one) => !one.resolvable);
  const limit =
    calibration &&
    Object.entries(calibration.thresholds)
      .map(([test, value]) => `${text.tests[test] ?? test} ${number(value, 3)}`)
      .join(', ');
  return h(
    'li',
    {},
    chip(place),
    h('b', {}, observer),
    ' ',
    note ? text.said(note) : said.join(text.andThen) || live.sentences.quiet(),
    limit && h('span', {class: 'soft'}, ` ${text.thresholdOf(limit)}`),
    lost.map((one) => h('span', {class: 'soft'}, ` ${capital(spoken(text.said(one.text), plant, live))}.`)),
  );
}
