// Step 2: does the model fit the healthy stretch? In words and numbers, before any fault is named.

import {h, number, symbol} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {heading, link} from '../../../widgets/controls.js';
import {percent} from '../numbers.js';
import {picture} from '../picture/picture.js';
import {gapsOf, stripsOf} from '../read/read-step.js';
import {innovationStrips} from '../findings/observer-strips.js';
import {refusalCard} from '../refusal.js';
import {parametersCard} from './parameters.js';
import {stretchOver} from './stretch.js';
import {suspectsCard} from './suspects.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Diagnosis, RecordActions, RecordState} from '../types.js' */

const BIASED = 4; // standard errors, as the service judges
const COLOURED = 1e-6; // probability

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function fitStep(state, act) {
  const {diagnosis} = state;
  return [
    h('div', {class: 'main-column'}, refusalCard(state), diagnosis && verdictCard(diagnosis), pictureCard(state, act)),
    h(
      'div',
      {class: 'side-column'},
      diagnosis && suspectsCard(state, diagnosis, act),
      parametersCard(state, act),
      diagnosis && diagnosis.notes.length > 0 && notesCard(diagnosis),
    ),
  ];
}

/** @param {Diagnosis} diagnosis */
const notesCard = ({notes}) =>
  h(
    'section',
    {class: 'card'},
    h('h2', {}, t('page.records.notes')),
    notes.map((one) => h('p', {class: 'soft'}, sentence(one))),
  );

/** @param {Diagnosis} diagnosis */
function verdictCard({fit, healthy}) {
  const {outputs, before, text, verdict, reasons} = fit;
  const stretch = `${number(healthy.begin, 5)} … ${number(healthy.end, 5)} s`;
  const two = before.length > 0;
  return h(
    'section',
    {class: `card verdict-card ${verdict}`, role: 'status'},
    h('p', {class: 'verdict'}, reasons.length > 0 ? t('page.records.misfit') : sentence(text)),
    reasons.length > 0 &&
      h(
        'ul',
        {class: 'reasons'},
        reasons.map((one) => h('li', {}, sentence(one.text))),
      ),
    h(
      'div',
      {class: 'wide', tabindex: 0, role: 'region', 'aria-label': t('page.records.fit.table')},
      h(
        'table',
        {class: 'fits'},
        h('thead', {}, two && groupHeads(stretch), columnHeads(two)),
        h(
          'tbody',
          {},
          outputs.map((one, place) =>
            h('tr', {}, h('th', {scope: 'row'}, symbol(one.output)), two && cells(before[place]), cells(one)),
          ),
        ),
      ),
    ),
    !two && h('p', {class: 'soft'}, t('page.records.fit.on', {stretch})),
  );
}

/** @param {string} stretch */
const groupHeads = (stretch) =>
  h(
    'tr',
    {class: 'groups'},
    h('td', {}),
    h(
      'th',
      {colspan: 5, scope: 'colgroup'},
      h('span', {class: 'chip', style: '--c:var(--o1)'}),
      ' ',
      t('page.records.fit.as-it-is'),
    ),
    h(
      'th',
      {colspan: 5, scope: 'colgroup'},
      h('span', {class: 'chip', style: '--c:var(--o0)'}),
      ' ',
      t('page.records.fit.fitted', {stretch}),
    ),
  );

/** @param {boolean} two */
function columnHeads(two) {
  const group = ['predicted', 'simulated', 'noise', 'bias', 'white'].map((key) =>
    h('th', {scope: 'col', title: t(`page.records.fit.${key}.hint`)}, t(`page.records.fit.${key}`)),
  );
  const all = two ? [...group, ...group.map((one) => one.cloneNode(true))] : group;
  return h('tr', {}, h('td', {}), all);
}

/** @param {service.OutputFitReport} fit */
function cells({predicted, simulated, noise, unit, memory, bias, whiteness}) {
  const biased = Math.abs(bias) > BIASED;
  const coloured = whiteness < COLOURED;
  return [
    h('td', {class: grade(predicted)}, share(predicted)),
    h('td', {class: grade(simulated)}, share(simulated)),
    h(
      'td',
      {title: memory > 0.01 ? t('page.records.fit.memory', {memory: number(memory, 2)}) : null},
      `${number(noise, 3)}${unit ? `\u202f${unit}` : ''}`,
    ),
    h('td', {class: biased ? 'bad' : ''}, `${number(bias, 2)}`),
    h(
      'td',
      {class: coloured ? 'bad' : 'good'},
      coloured ? t('page.records.fit.not-white') : t('page.records.fit.is-white'),
    ),
  ];
}

/** @param {number | null} fit */
const share = (fit) => (fit === null || fit < 0 ? t('page.records.fit.none') : percent(fit));

/** @param {number | null} fit */
const grade = (fit) => (fit === null || fit < 0.5 ? 'bad' : fit < 0.85 ? 'fair' : '');

/**
 * The readings with the healthy stretch over them.
 * @param {RecordState} state
 * @param {RecordActions} act
 */
function pictureCard(state, act) {
  const {preview, inspection, diagnosis, settings} = state;
  if (!preview || !inspection?.times) return null;
  const {duration, period} = inspection.times;
  const found = diagnosis?.healthy;
  const stretch = settings.healthy ?? (found ? {begin: found.begin, end: found.end} : null);
  return h(
    'section',
    {class: 'card picture-card'},
    heading(
      t('page.records.measured'),
      h(
        'span',
        {class: 'legend'},
        diagnosis?.simulated && [
          h('span', {class: 'chip', style: '--c:var(--soft)'}),
          t('page.records.legend.measured'),
          h('span', {class: 'chip', style: '--c:var(--o0)'}),
          diagnosis.fit.verdict === 'fits-after-fit'
            ? t('page.records.legend.simulated-fitted')
            : t('page.records.legend.simulated'),
        ],
        h('span', {class: 'swatch healthy'}),
        t('page.records.healthy'),
        h('span', {class: 'swatch gap'}),
        t('page.records.no-data'),
      ),
    ),
    stretch && stretchFields(stretch, state, act),
    picture({
      duration,
      strips: [
        ...stripsOf(preview, state.plant, diagnosis?.simulated),
        ...(state.plant
          ? innovationStrips(diagnosis?.innovations, state.plant, {count: preview.t.length, duration})
          : []),
      ],
      bands: gapsOf(inspection, preview.t[0] ?? 0),
      over:
        stretch &&
        stretchOver({
          stretch,
          record: {duration, period},
          change: (healthy) => act.set({healthy}),
        }),
      label: t('page.records.measured'),
    }),
  );
}

/**
 * The ends of the stretch as numbers.
 * @param {{begin: number, end: number}} stretch
 * @param {RecordState} state
 * @param {RecordActions} act
 */
function stretchFields(stretch, {settings, inspection}, act) {
  /** @param {'begin' | 'end'} which */
  const field = (which) => {
    const input = h('input', {
      id: `healthy-${which}`,
      class: 'time',
      inputmode: 'decimal',
      autocomplete: 'off',
      value: Number(stretch[which].toPrecision(7)),
      'aria-label': which === 'begin' ? t('page.records.healthy.begin') : t('page.records.healthy.end'),
      onchange: () => {
        const at = Number(input.value.replace(',', '.'));
        const next = {...stretch, [which]: at};
        const valid =
          Number.isFinite(at) &&
          next.begin >= 0 &&
          next.end > next.begin &&
          next.begin < (inspection?.times?.duration ?? 0);
        input.setAttribute('aria-invalid', String(!valid));
        if (valid) act.set({healthy: next});
      },
    });
    return input;
  };
  return h(
    'p',
    {class: 'stretch-fields'},
    h('span', {}, t('page.records.healthy.from')),
    field('begin'),
    '…',
    field('end'),
    's',
    settings.healthy
      ? link(t('page.records.healthy.find'), () => act.set({healthy: null}), {id: 'healthy-find'})
      : h('span', {class: 'soft'}, t('page.records.healthy.found')),
  );
}
