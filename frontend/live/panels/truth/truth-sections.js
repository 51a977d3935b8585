// The sections of the panel: parameters, process noise, sensors, unmodelled dynamics.

import {h, symbol} from '../../../common/dom.js';
import {called, split} from '../../../common/names.js';
import {perRoot} from '../../../widgets/truth-differences.js';
import {linear} from '../../../widgets/slider-scale.js';
import {badge} from '../../../widgets/controls.js';
import {named, t} from '../../../i18n/words.js';
import * as edits from './truth-edits.js';
import * as scales from './truth-scales.js';
import {numberRow, section, textRow} from './truth-rows.js';

/** @import {App, Experiment, Plant} from '../../types.js' */
/** @import {Row} from './truth-rows.js' */
/** @import {Edit, SensorField, Truth} from './truth-edits.js' */

/**
 * The experiment, and where edits go.
 * @typedef {object} Context
 * @property {App} app
 * @property {Plant} plant
 * @property {Experiment} spec
 * @property {(path: string, edit: Edit) => void} change
 * @property {() => Truth} shown
 */

/** @typedef {{element: HTMLDetailsElement, rows: Row[], follow: (truth: Truth) => void}} Section */

const MOST_OFF = 50; // per cent, of parameters
const MOST_LOST = 95; // per cent, of samples

/**
 * @param {string} title
 * @param {Row[]} rows
 * @param {import('../../../types/dom.js').Child[]} children
 * @param {(truth: Truth) => number} count
 * @returns {Section}
 */
function made(title, rows, children, count) {
  const {element, follow} = section(title, children, count);
  return {
    element,
    rows,
    follow(truth) {
      follow(truth);
      for (const row of rows) row.follow(truth);
    },
  };
}

/** @param {Context} context */
export function parameterSection({plant, spec, change}) {
  const deviation = numberRow({
    path: 'deviation',
    label: t('page.truth.all'),
    room: Infinity,
    name: t('page.inject.model-of'),
    hint: t('page.inject.model-hint'),
    unit: '%',
    scale: linear(0, 10),
    low: 0,
    high: MOST_OFF,
    value: (truth) => 100 * truth.deviation,
    differs: (truth) => truth.deviation > 0,
    change: (percent) => change('deviation', edits.setDeviation(percent / 100)),
    back: () => change('deviation', edits.setDeviation(0)),
  });
  const rows = plant.parameters.map((parameter) => {
    const {name, unit, bounds, description} = parameter;
    const model = scales.modelValue(parameter, spec);
    const path = `parameters.${name}`;
    return numberRow({
      path,
      label: symbol(name),
      name: t('page.truth.parameter', {name: called(name, null)}),
      hint: [named(description), t('page.truth.in-the-model', {value: String(model)})].filter(Boolean).join('; '),
      unit,
      scale: scales.parameterScale(model, bounds),
      low: bounds[0] ?? -Infinity,
      high: bounds[1] ?? Infinity,
      value: (truth) => truth.parameters[name] ?? model,
      differs: (truth) => name in truth.parameters,
      change: (value) => change(path, edits.setParameter(name, value, model)),
      back: () => change(path, edits.setParameter(name, null, model)),
    });
  });
  const all = [deviation, ...rows];
  return made(
    t('page.truth.parameters'),
    all,
    all.map((row) => row.element),
    (truth) => Object.keys(truth.parameters).length + Number(truth.deviation > 0),
  );
}

/** @param {Context} context */
export function noiseSection({app, plant, spec, change}) {
  const rows = plant.states.map((state) => {
    const path = `process_noise.${state.name}`;
    const scale = () =>
      scales.noiseScale(scales.sizeOf(state, app.range(`x.${state.name}`, 0, app.state.t)), spec.horizon);
    return numberRow({
      path,
      label: symbol(state.name),
      name: t('page.truth.noise-of', {name: called(state.name, plant)}),
      hint: named(state.description),
      unit: perRoot(state.unit),
      scale: scale(),
      fit(truth, present) {
        if (!truth.process_noise[state.name]) Object.assign(present, scale()); // rows have come in
      },
      low: 0,
      value: (truth) => truth.process_noise[state.name] ?? 0,
      differs: (truth) => (truth.process_noise[state.name] ?? 0) > 0,
      change: (std) => change(path, edits.setProcessNoise(state.name, std)),
      back: () => change(path, edits.setProcessNoise(state.name, 0)),
    });
  });
  return made(
    t('page.truth.process-noise'),
    rows,
    [h('p', {class: 'soft'}, t('page.truth.process-noise.hint')), rows.map((row) => row.element)],
    (truth) => plant.states.filter(({name}) => (truth.process_noise[name] ?? 0) > 0).length,
  );
}

/** @param {Context} context */
export function sensorSection(context) {
  const groups = context.plant.outputs.map((output) => sensorRows(context, output));
  const rows = groups.flat();
  return made(
    t('page.truth.sensors'),
    rows,
    [
      h('p', {class: 'soft'}, t('page.truth.sensors.hint')),
      context.plant.outputs.map((output, place) =>
        h(
          'div',
          {class: 'truth-sensor', role: 'group', 'aria-label': called(output.name, context.plant)},
          h(
            'p',
            {class: 'truth-output'},
            badge(split(output.name), {square: true}),
            named(output.description) || output.name,
          ),
          groups[place].map((row) => row.element),
        ),
      ),
    ],
    (truth) => rows.filter(({path}) => differs(truth, path)).length,
  );
}

/**
 * Whether a field of a sensor differs from the model's; `path`: outputs.y.period.
 * @param {Truth} truth
 * @param {string} path
 */
function differs(truth, path) {
  const field = /** @type {SensorField} */ (path.slice(path.lastIndexOf('.') + 1));
  const output = path.slice('outputs.'.length, path.lastIndexOf('.'));
  return Boolean(edits.sensorOf(truth, output)[field]);
}

/**
 * The rows of one sensor.
 * @param {Context} context
 * @param {Plant['outputs'][number]} output
 * @returns {Row[]}
 */
function sensorRows({app, plant, spec, change, shown}, {name, unit}) {
  const {step, noise} = app.state;
  const own = scales.periodOf(plant, spec, noise[name]);
  const least = Math.max(step, own ?? 10 * step);
  /**
   * @param {'correlation' | 'period' | 'missing' | 'jitter'} field
   * @param {Partial<Parameters<typeof numberRow>[0]> & Pick<Parameters<typeof numberRow>[0], 'scale'>} more
   */
  const row = (field, more, factor = 1) => {
    const path = `outputs.${name}.${field}`;
    const none = field === 'correlation' || field === 'period' ? null : 0;
    /** @param {number | null} value */
    const set = (value) => change(path, edits.setSensor(name, field, value, step));
    return numberRow({
      path,
      label: t(`page.truth.sensor.${field}`),
      room: Infinity,
      name: t(`page.truth.sensor-of.${field}`, {name: called(name, plant)}),
      hint: t(`page.truth.sensor-hint.${field}`),
      unit: 's',
      low: 0,
      value: (truth) => factor * (edits.sensorOf(truth, name)[field] ?? 0),
      differs: (truth) => differs(truth, path),
      change: (value) => set(value === 0 ? none : value / factor),
      back: () => set(none),
      ...more,
    });
  };
  /** @param {number} value */
  const snap = (value) => Math.max(step, edits.onGrid(value, step));
  /** The longest delay: a step less than the period. */
  const longest = () => {
    const period = edits.sensorOf(shown(), name).period ?? own;
    return period === null ? Infinity : Math.max(0, edits.onGrid(period - step, step));
  };
  const path = `outputs.${name}.adds`;
  return [
    row('correlation', {scale: scales.timeScale(least, spec.horizon)}),
    row('period', {scale: scales.timeScale(least, spec.horizon), snap}),
    row('missing', {scale: linear(0, MOST_LOST), high: MOST_LOST, unit: '%'}, 100),
    row('jitter', {
      scale: scales.jitterScale(own, step),
      snap: (value) => Math.min(edits.onGrid(value, step), longest()),
      fit(truth, scale) {
        scale.max = scales.jitterScale(edits.sensorOf(truth, name).period ?? own, step).max;
      },
    }),
    textRow({
      path,
      label: [symbol(name), ' +'],
      name: t('page.truth.sensor-of.adds', {name: called(name, plant)}),
      hint: [t('page.truth.sensor-hint.adds'), unit].filter(Boolean).join(', '),
      placeholder: t('page.truth.nothing'),
      value: (truth) => edits.sensorOf(truth, name).adds ?? '',
      change: (text) => change(path, edits.setSensor(name, 'adds', text.trim() || null, step)),
    }),
  ];
}
