// Recorded data, diagnosed: a plant, a file of columns, and which faults it shows.

import {connection, get, post, Problem} from '../../common/api.js';
import {fill, h, number, query, symbol} from '../../common/dom.js';
import {alarmFrom} from '../../diagnosis/alarms.js';
import {badge} from '../../widgets/controls.js';
import {amount} from '../../diagnosis/fault-size.js';
import {badges, called, capital, split, spoken} from '../../common/names.js';
import {problemBlock} from '../../common/problem.js';
import {mountTop} from '../../common/page-header.js';
import {columnsOf, needed} from './csv.js';
import {chosenLanguage} from '../../i18n/language.js';
import {asSentence, named, speak, t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */
/** @import {Alarm} from '../../live/types.js' */
/** @import {Plant} from '../types.js' */
/** @import {Child} from '../../types/dom.js' */

const POINTS = 1200;
const SLOT = '\u0000'; // where elements take the place of an argument
await speak(chosenLanguage());

/**
 * A recorded output over time, with the alarms.
 * @param {Plant['outputs'][number]} output
 * @param {number[]} time
 * @param {number[]} y
 * @param {Alarm[]} alarms
 */
function course(output, time, y, alarms) {
  const [first, last] = [time[0], time[time.length - 1]];
  const [low, high] = y.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  /** @param {number} at */
  const x = (at) => ((at - first) / (last - first || 1)) * 1000;
  /** @param {number} v */
  const up = (v) => 97 - ((v - low) / (high - low || 1)) * 94;
  const every = Math.max(1, Math.floor(time.length / POINTS));
  const path = time
    .map((at, k) => [at, y[k]])
    .filter((_, k) => k % every === 0)
    .map(([at, v], k) => `${k ? 'L' : 'M'}${x(at).toFixed(1)} ${up(v).toFixed(1)}`)
    .join('');
  return h(
    'div',
    {class: 'course'},
    h(
      'span',
      {},
      symbol(output.name),
      h('span', {class: 'soft'}, ` ${named(output.description)}${output.unit ? `, ${output.unit}` : ''}`),
    ),
    h(
      'svg',
      {viewBox: '0 0 1000 100', preserveAspectRatio: 'none', role: 'img', 'aria-label': output.name},
      alarms.map((one) => [
        h('rect', {x: x(one.from), y: 0, width: Math.max(1, x(one.to) - x(one.from)), height: 100}),
        h('line', {x1: x(one.onset), x2: x(one.onset), y1: 0, y2: 100}),
      ]),
      h('path', {d: path}),
    ),
    h(
      'div',
      {class: 'ends'},
      h('span', {}, `${number(first)} s`),
      h('span', {}, `${number(low, 3)} … ${number(high, 3)}`),
      h('span', {}, `${number(last)} s`),
    ),
  );
}

/**
 * The line of an alarm in the table.
 * @param {Alarm} one
 * @param {Plant} plant
 * @param {Map<string, [string, string]>} short
 */
function row(one, plant, short) {
  const channel = plant.channels.find(({name}) => name === one.subject);
  const names = one.explained ? one.subjects : [one.subject];
  const title = one.explained
    ? named(channel?.title ?? '') || called(one.subject, plant)
    : capital(called(one.subject, plant));
  return h(
    'tr',
    {},
    h(
      'td',
      {class: 'name'},
      names.map((name, k) => [
        k > 0 && ` ${t('page.diagnosis.or')} `,
        badge(short.get(name) ?? split(name), {square: !one.explained}),
      ]),
      ' ',
      title,
    ),
    h('td', {}, one.explained ? amount(one, channel) : '–', one.explained && channel?.unit ? ` ${channel.unit}` : ''),
    h('td', {}, number(one.onset, 5)),
    h('td', {}, one.from === one.to ? '–' : `${number(one.from, 5)} … ${number(one.to, 5)}`),
    h('td', {}, number(one.t, 5)),
    h('td', {}, one.over === null ? t('page.records.still-on') : number(one.over, 5)),
  );
}

/**
 * The findings: the sentence, one line each, the outputs, and the calibration behind them.
 * @param {service.ObserverDiagnosis} diagnosis
 * @param {Plant} plant
 * @param {{[column: string]: number[]}} columns
 */
function findings(diagnosis, plant, columns) {
  const time = columns.t ?? columns.time;
  const begin = time?.[0] ?? 0; // the diagnosis counts from the first row on
  const alarms = diagnosis.alarms.map(alarmFrom).map((one) => ({
    ...one,
    t: one.t + begin,
    onset: one.onset + begin,
    from: one.from + begin,
    to: one.to + begin,
    over: one.over === null ? null : one.over + begin,
  }));
  const short = badges(plant.channels);
  const heads = [
    t('page.records.column.fault'),
    t('page.records.column.size'),
    t('page.records.column.onset'),
    t('page.records.column.interval'),
    t('page.records.column.detected'),
    t('page.records.column.cleared'),
  ];
  const table =
    alarms.length > 0 &&
    h(
      'div',
      {class: 'wide', tabindex: 0},
      h(
        'table',
        {class: 'measures'},
        h(
          'thead',
          {},
          h(
            'tr',
            {},
            heads.map((head) => h('th', {scope: 'col'}, head)),
          ),
        ),
        h(
          'tbody',
          {},
          alarms.map((one) => row(one, plant, short)),
        ),
      ),
    );
  const shown = plant.outputs
    .map((output) => ({output, y: columns[`y.${output.name}`] ?? columns[output.name]}))
    .filter(({y}) => y && time);
  const {calibration, noise} = diagnosis;
  return [
    h(
      'section',
      {class: 'card found', role: 'status'},
      h('h2', {}, t('page.diagnosis.title')),
      h(
        'p',
        {class: 'verdict'},
        alarms.length ? t('page.records.faults', {n: alarms.length}) : t('page.records.no-fault'),
      ),
      table,
      calibration &&
        h(
          'p',
          {class: 'soft'},
          [
            ...noise.map((one) =>
              t('page.records.noise', {output: called(one.output, plant), std: number(one.estimated, 3)}),
            ),
            t('page.records.calibrated', {
              rate: number(calibration.false_alarms),
              runs: calibration.seeds,
              from: number(calibration.from_time, 3),
            }),
          ].join(' '),
        ),
      diagnosis.note && h('p', {class: 'soft'}, asSentence(spoken(diagnosis.note, plant))),
    ),
    shown.length > 0 &&
      h(
        'section',
        {class: 'card'},
        h('h2', {}, t('page.records.recorded')),
        shown.map(({output, y}) => course(output, time, y, alarms)),
      ),
  ];
}

const root = query('.records');
/** @type {service.ExperimentList} */
const {experiments} = await get('/api/experiments');
/** @type {service.PlantList} */
let {plants} = await get('/api/plants');
/** @type {Map<string, Plant>} plants in full, in the page's language */
const known = new Map();

/**
 * A plant of the library in full.
 * @param {string} id
 * @returns {Promise<Plant>}
 */
async function plantOf(id) {
  /** @type {Plant} */
  const plant = known.get(id) ?? (await get(`/api/plants/${encodeURIComponent(id)}`));
  known.set(id, plant);
  return plant;
}

const choice = h(
  'select',
  {id: 'plant'},
  plants.map((line) => h('option', {value: line.id})),
);
const file = h('input', {id: 'file', type: 'file', accept: '.csv,text/csv,text/plain'});
const learn = h('input', {id: 'learn', type: 'number', min: 0, step: 'any', value: 0});
const rate = h('input', {id: 'rate', type: 'number', min: 0, step: 'any', value: 1});
const names = h('p', {class: 'soft all names'});
const state = h('span', {class: 'soft', role: 'status'});
const result = h('div', {class: 'records'});
/** @type {string | null} text of a simulated record */
let taken = null;
// the text beside the buttons and the content below: functions, so that they can be shown again in another language
/** @type {() => string} */
let beside = () => '';
/** @type {() => Child} */
let below = () => [];

/** @param {() => string} words */
const say = (words) => {
  beside = words;
  fill(state, beside());
};
/** @param {() => Child} elements */
const show = (elements) => {
  below = elements;
  fill(result, below());
};

async function showNames() {
  const plant = await plantOf(choice.value);
  const columns = ['t', ...[...plant.inputs, ...plant.signals, ...plant.outputs].map((one) => one.name)];
  // the names are within a sentence, as code
  const [before, after] = t('page.records.columns', {columns: SLOT}).split(SLOT);
  fill(
    names,
    before,
    columns.map((name, k) => [k > 0 && ', ', h('code', {}, name)]),
    after,
  );
}

/**
 * Do something that the server may refuse; the words that it returns are shown beside the buttons.
 * @param {() => Promise<(() => string) | void>} work
 */
async function attempt(work) {
  say(() => t('page.runs.running'));
  try {
    say((await work()) ?? (() => ''));
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    show(() => [problemBlock(error)]);
    say(() => '');
  }
}

/**
 * Diagnose a record.
 * @param {string} csv
 */
async function ask(csv) {
  const plant = await plantOf(choice.value);
  /** @type {service.ObserverDiagnosis} */
  const diagnosis = await post('/api/diagnosis', {
    plant: plant.id,
    csv: needed(csv, plant),
    learn: Number(learn.value),
    diagnosis: {false_alarms: Number(rate.value)},
  });
  const columns = columnsOf(csv);
  show(() => findings(diagnosis, known.get(plant.id) ?? plant, columns));
}

/** A run of the plant's first experiment as a record, for those who have none of their own. */
async function simulated() {
  const experiment =
    experiments.find((one) => one.plant === choice.value && one.observers.length > 0) ??
    experiments.find((one) => one.plant === choice.value);
  if (!experiment) return () => '';
  const {id} = experiment;
  const [run, plant] = await Promise.all([
    /** @type {Promise<service.Run>} */ (
      post('/api/runs?wait=60', {experiment: id, set: {observers: [], figures: []}})
    ),
    plantOf(choice.value),
  ]);
  const columns = [
    't',
    ...plant.inputs.map((one) => `u.${one.name}`),
    ...plant.signals.map((one) => `signal.${one.name}`),
    ...plant.outputs.map((one) => `y.${one.name}`),
  ];
  const answer = await fetch(`/api/runs/${run.id}/data?format=csv&columns=${columns.join(',')}`);
  taken = await answer.text();
  return () => t('page.records.simulated', {id});
}

/** @param {SubmitEvent} event */
async function submit(event) {
  event.preventDefault();
  const csv = taken ?? (await file.files?.[0]?.text());
  if (csv) attempt(() => ask(csv));
  else say(() => t('page.records.no-file'));
}

/** Build the page in the present language. The choices and the results remain. */
function build() {
  query('.skip').textContent = t('page.records.title');
  plants.forEach((line, place) => {
    choice.options[place].textContent = named(line.title) || line.id;
  });
  const form = h(
    'form',
    {class: 'card ask', onsubmit: submit},
    h('label', {}, t('page.records.plant'), choice),
    h('label', {}, t('page.records.file'), file),
    h('label', {title: t('page.records.learn.hint')}, t('page.records.learn'), learn),
    h('label', {title: t('page.records.rate.hint')}, t('page.records.rate'), rate),
    names,
    h(
      'div',
      {class: 'all buttons'},
      h('button', {class: 'run', type: 'submit'}, t('page.records.diagnose')),
      h('button', {class: 'quiet', type: 'button', onclick: () => attempt(simulated)}, t('page.records.simulate')),
      state,
    ),
  );
  fill(root, h('h1', {}, t('page.records.title')), h('p', {class: 'soft'}, t('page.records.about')), form, result);
  say(beside);
  show(below);
  showNames();
}

choice.addEventListener('change', () => {
  taken = null;
  say(() => '');
  showNames();
});
file.addEventListener('change', () => {
  taken = null;
  say(() => '');
});
mountTop(query('.top'), connection, 'records', async () => {
  known.clear();
  ({plants} = await get('/api/plants'));
  await plantOf(choice.value);
  build();
});
build();
