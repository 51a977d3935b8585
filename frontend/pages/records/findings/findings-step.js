// Step 3: the faults of the record, one row each, over the readings and the statistic that found them.

import {h, number, symbol} from '../../../common/dom.js';
import {badges, plain, split} from '../../../common/names.js';
import {small} from '../../../diagnosis/fault-size.js';
import {named, t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {badge, chip, heading} from '../../../widgets/controls.js';
import {span} from '../numbers.js';
import {picture} from '../picture/picture.js';
import {gapsOf, lengthOf, stripsOf} from '../read/read-step.js';
import {faultTable, titleOf, withTitles} from './fault-table.js';
import {estimateStrips, innovationStrips, residualStrips, shownObservers, withEstimates} from './observer-strips.js';
import {observersCard} from './observers-card.js';
import {runCard} from './run-card.js';

/** @import {Band, Diagnosis, Mark, Plant, RecordActions, RecordState, Strip} from '../types.js' */

const STATISTIC = 'statistic'; // key of its strip
const BRIDGED = 5; // intervals
const LEAST = 1e-3; // of the threshold; below it the curve is not drawn

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function findingsStep(state, act) {
  const {diagnosis, plant, preview, inspection, runs} = state;
  if (!diagnosis || !plant) return null;
  const observers = shownObservers(runs);
  const duration = inspection ? lengthOf(inspection) : diagnosis.duration;
  const noise = Object.fromEntries(diagnosis.fit.outputs.map((one) => [one.output, one.noise]));
  return [
    h(
      'div',
      {class: 'main-column'},
      h(
        'section',
        {class: 'card verdict-card', role: 'status'},
        h('p', {class: 'verdict'}, sentence(withTitles(diagnosis.sentence, diagnosis.faults, plant))),
        faultTable(diagnosis.faults, plant),
        h('p', {class: 'soft'}, quiet(diagnosis, inspection ? lengthOf(inspection) : diagnosis.duration)),
      ),
      preview &&
        inspection &&
        h(
          'section',
          {class: 'card picture-card'},
          heading(t('page.records.record'), legend(observers)),
          picture({
            duration,
            strips: [
              ...estimateStrips(observers, plant),
              ...withEstimates(stripsOf(preview, plant), observers, preview),
              ...residualStrips(observers, plant, noise),
              ...(observers.length
                ? []
                : innovationStrips(diagnosis.innovations, plant, {count: preview.t.length, duration})),
              ...statistic(diagnosis, preview.t.length, duration),
            ],
            bands: [...gapsOf(inspection, preview.t[0] ?? 0), ...faultBands(diagnosis, lengthOf(inspection))],
            marks: alarmMarks(
              diagnosis,
              plant,
              observers.length && plant.channels.length
                ? `theta.${plant.channels[0].name}`
                : (preview.series[0]?.name ?? STATISTIC),
            ),
            label: t('page.records.record'),
          }),
        ),
    ),
    h(
      'div',
      {class: 'side-column'},
      observersCard(state, act),
      runCard(state, act),
      missingCard(diagnosis),
      visibleCard(diagnosis, plant),
      certaintyCard(diagnosis, act),
      historyCard(diagnosis, plant),
    ),
  ];
}

/** @param {Diagnosis} diagnosis @param {number} duration  s */
const quiet = ({healthy, false_alarms}, duration) =>
  t('page.records.quiet', {
    rate: number(false_alarms, 3),
    begin: number(healthy.begin, 5),
    end: number(healthy.end, 5),
    length: span(duration),
  });

/** @param {ReturnType<typeof shownObservers>} observers */
const legend = (observers) =>
  h(
    'span',
    {class: 'legend'},
    observers.map(({colour, title}) => [chip(colour), title]),
    h('span', {class: 'swatch fault'}),
    t('page.records.legend.fault'),
    h('span', {class: 'alarm', 'aria-hidden': 'true'}, '▼'),
    t('page.records.legend.alarm'),
    h('span', {class: 'swatch gap'}),
    t('page.records.no-data'),
  );

/**
 * The statistic against its threshold.
 * @param {Diagnosis} diagnosis
 * @param {number} count   intervals of the picture
 * @param {number} duration   s
 * @returns {Strip[]}
 */
function statistic({statistic: curve, threshold}, count, duration) {
  if (!curve || curve.t.length === 0) return [];
  /** @type {(number | null)[]} */
  const largest = Array(Math.max(1, Math.min(count, curve.t.length))).fill(null);
  const least = (threshold ?? Math.max(...curve.largest)) * LEAST;
  curve.t.forEach((at, place) => {
    if (!(curve.largest[place] > least)) return; // a new fault is named: nothing is judged
    const k = Math.min(largest.length - 1, Math.floor((at / (duration || 1)) * largest.length));
    largest[k] = Math.max(largest[k] ?? -Infinity, curve.largest[place]);
  });
  return [
    {
      key: STATISTIC,
      label: h('i', {class: 'math'}, 'T'),
      title: t('page.records.statistic'),
      unit: '',
      low: largest,
      high: largest,
      logarithmic: true,
      bridged: BRIDGED,
      line: threshold === null ? undefined : {at: threshold, title: t('page.records.threshold')},
    },
  ];
}

/** @param {Diagnosis} diagnosis @param {number} duration  s @returns {Band[]} */
const faultBands = ({faults}, duration) =>
  faults.flatMap(({best, ended, text}) => [
    {from: best.onset.value, to: ended ?? duration, kind: /** @type {const} */ ('fault'), title: sentence(text)},
    {from: Math.max(0, best.onset.low), to: best.onset.high, kind: /** @type {const} */ ('onset')},
  ]);

/** @param {Diagnosis} diagnosis @param {Plant} plant @param {string} strip @returns {Mark[]} */
const alarmMarks = ({faults}, plant, strip) =>
  faults.map(({alarm, best}) => ({
    t: alarm,
    strip,
    sign: '▼',
    title: t('page.records.noticed-at', {fault: titleOf(best, plant), t: number(alarm, 5)}),
    kind: 'alarm',
  }));

/** @param {Diagnosis} diagnosis */
const missingCard = ({missing}) =>
  missing.length > 0 &&
  h(
    'section',
    {class: 'card'},
    h('h2', {}, t('page.records.missing')),
    h(
      'ul',
      {class: 'advice'},
      missing.map((one) => h('li', {}, sentence(one.text))),
    ),
  );

/** @param {Diagnosis} diagnosis @param {Plant} plant */
function visibleCard({visible, faults}, plant) {
  if (visible.length === 0) return null;
  const short = badges(plant.channels);
  const title = faults.length ? t('page.records.visible') : t('page.records.visible.none-found');
  return h(
    'section',
    {class: 'card'},
    h('h2', {}, title),
    h('p', {class: 'soft'}, t('page.records.visible.hint')),
    h(
      'ul',
      {class: 'visible-faults'},
      visible.map(({channel, unit, smallest}) => {
        const known = plant.channels.find((one) => one.name === channel);
        return h(
          'li',
          {},
          badge(short.get(channel) ?? split(channel)),
          h('span', {}, named(known?.title) || plain(channel)),
          h(
            'span',
            {class: smallest === null ? 'unseen' : 'num'},
            smallest === null ? t('page.records.visible.never') : `${small(smallest)}${unit ? `\u202f${unit}` : ''}`,
          ),
        );
      }),
    ),
  );
}

/** @param {Diagnosis} diagnosis @param {RecordActions} act */
function certaintyCard({notes, false_alarms: rate}, act) {
  const field = h('input', {
    id: 'false-alarms',
    inputmode: 'decimal',
    autocomplete: 'off',
    value: rate,
    onchange: () => {
      const value = Number(field.value.replace(',', '.'));
      const valid = Number.isFinite(value) && value > 0;
      field.setAttribute('aria-invalid', String(!valid));
      if (valid && value !== rate) {
        act.set({false_alarms: value});
        act.diagnose();
      }
    },
  });
  return h(
    'section',
    {class: 'card'},
    h('h2', {}, t('page.records.how-sure')),
    h('p', {}, t('page.records.how-sure.text')),
    notes.map((one) => h('p', {class: 'soft'}, sentence(one))),
    h('label', {class: 'rate-field', for: 'false-alarms'}, t('page.records.rate'), field),
  );
}

/** @param {Diagnosis} diagnosis @param {Plant} plant */
function historyCard({decisions}, plant) {
  if (decisions.length === 0) return null;
  const heads = ['alarm', 'statistic', 'named', 'onset'].map((key) =>
    h('th', {scope: 'col'}, t(`page.records.history.${key}`)),
  );
  return h(
    'details',
    {class: 'card history'},
    h('summary', {}, t('page.records.history', {n: decisions.length})),
    h('p', {class: 'soft'}, t('page.records.history.hint')),
    h(
      'div',
      {class: 'wide', tabindex: 0, role: 'region', 'aria-label': t('page.records.history', {n: decisions.length})},
      h(
        'table',
        {class: 'decisions'},
        h('thead', {}, h('tr', {}, heads)),
        h(
          'tbody',
          {},
          decisions.map(({t: at, statistic: size, action, channel, onset, judged}) =>
            h(
              'tr',
              {title: t('page.records.history.judged', {t: number(judged, 5)})},
              h('td', {}, number(at, 5)),
              h('td', {}, number(size, 3)),
              h('td', {}, channel ? symbol(channel) : '+', ' ', h('small', {}, actionWords(action, plant, channel))),
              h('td', {}, number(onset, 5)),
            ),
          ),
        ),
      ),
    ),
  );
}

/** @param {'added' | 'revised'} action @param {Plant} plant @param {string} channel */
const actionWords = (action, plant, channel) =>
  [named(plant.channels.find((one) => one.name === channel)?.title), t(`page.records.action.${action}`)]
    .filter(Boolean)
    .join(', ');
