// Step 1: the file as it was read, before anything is computed.

import {h, symbol} from '../../../common/dom.js';
import {brief} from '../../../common/names.js';
import {t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {heading} from '../../../widgets/controls.js';
import {picture} from '../picture/picture.js';
import {columnsCard, itemOf} from './columns.js';
import {dropZone, earlierCard} from './drop.js';
import {findingsCard} from './findings-list.js';
import {plantCard} from './plant-card.js';

/** @import {Band, Diagnosis, Inspection, Mark, Plant, Preview, RecordActions, RecordState, Strip} from '../types.js' */

const MOST_MARKS = 60;
const MOST_STRIPS = 24;
const STEPS = 'steps'; // key of the strip of times from row to row

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function readStep(state, act) {
  const {inspection, preview, problem} = state;
  if (!inspection)
    return [
      h('div', {class: 'main-column'}, dropZone(state, act), problem && findingsCard(state, act)),
      h('div', {class: 'side-column'}, plantCard(state, act), earlierCard(state)),
    ];
  return [
    h(
      'div',
      {class: 'main-column'},
      dropZone(state, act),
      columnsCard(state, act),
      preview && previewCard(inspection, preview, state.plant),
    ),
    h(
      'div',
      {class: 'side-column'},
      state.choice === null
        ? [plantCard(state, act), findingsCard(state, act)]
        : [findingsCard(state, act), plantCard(state, act)],
    ),
  ];
}

/**
 * The preview's curves as strips; times from row to row last.
 * @param {Preview} preview
 * @param {Plant | null} plant
 * @param {Diagnosis['simulated']} [simulated]
 * @returns {Strip[]}
 */
export function stripsOf({series}, plant, simulated = null) {
  return series.slice(0, MOST_STRIPS).map(({name, role, column, unit, low, high}) => {
    const item = itemOf(name, plant);
    return {
      key: name,
      label: role === 'unused' ? '' : symbol(name),
      title: brief(item?.description) || column || '',
      unit,
      low,
      high,
      held: role === 'input' || role === 'signal',
      small: role !== 'output',
      second: simulated?.outputs[name] && {t: simulated.t, values: simulated.outputs[name]},
    };
  });
}

/**
 * Hatching where the record has no rows.
 * @param {Inspection} inspection
 * @param {number} begin   time of the first row
 * @returns {Band[]}
 */
export const gapsOf = ({findings}, begin) =>
  findings
    .filter(({kind, times, until}) => kind === 'gap' && times.length > 0 && until !== null)
    .map(({times, until}) => ({
      from: times[0] - begin,
      to: (until ?? times[0]) - begin,
      kind: 'gap',
      title: t('page.records.no-data'),
    }));

/** @param {Inspection} inspection @param {Preview} preview @param {Plant | null} plant */
function previewCard(inspection, preview, plant) {
  const [begin = 0] = preview.t;
  const strips = stripsOf(preview, plant);
  const period = inspection.times?.period ?? 1;
  strips.push({
    key: STEPS,
    label: h('span', {class: 'math'}, 'Δ', h('i', {}, 't')),
    title: t('page.records.steps'),
    unit: 's',
    low: preview.steps.low,
    high: preview.steps.high,
    small: true,
    most: 4 * period,
  });
  const keys = new Set(strips.map(({key}) => key));
  /** @type {Mark[]} */
  const marks = inspection.findings.slice(0, MOST_MARKS).map((one, place) => ({
    t: one.times.length
      ? one.times[0] - begin
      : ((place + 1) / (inspection.findings.length + 1)) * lengthOf(inspection),
    strip: one.quantity !== null && keys.has(one.quantity) ? one.quantity : STEPS,
    sign: place + 1,
    title: `${place + 1}: ${sentence(one.text)}`,
    kind: one.severity === 'wrong' ? 'wrong' : 'finding',
    id: one.id,
  }));
  return h(
    'section',
    {class: 'card picture-card'},
    heading(
      t('page.records.record'),
      h('span', {class: 'soft aside'}, marks.length > 0 && t('page.records.record.hint')),
    ),
    picture({
      duration: lengthOf(inspection),
      strips,
      bands: gapsOf(inspection, begin),
      marks,
      label: t('page.records.record'),
    }),
  );
}

/** The length of a record in s. @param {Inspection} inspection */
export const lengthOf = ({times}) => times?.duration ?? 1;
