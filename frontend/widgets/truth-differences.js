// How the simulated plant differs from the model that observers know: the differences of a truth, each as a message.

import {number} from '../common/dom.js';
import {called} from '../common/names.js';
import {t} from '../i18n/words.js';

/** @import {Plant} from '../pages/types.js' */
/** @import * as service from '../types/service.js' */

/** @typedef {service.Truth} Truth */
/** @typedef {{code: string, args: {[name: string]: string}}} Difference */

/** @type {Readonly<Truth>} */
export const AS_MODEL = {
  deviation: 0,
  parameters: {},
  process_noise: {},
  outputs: {},
  states: [],
  dynamics: {},
  record: null,
};

/**
 * A truth with all its fields.
 * @param {Partial<service.TruthInput> | null | undefined} truth
 * @returns {Truth}
 */
export const complete = (truth) => /** @type {Truth} */ ({...AS_MODEL, ...truth});

/**
 * Every difference between a truth and the model, in the order of its fields; empty: the plant is as the model.
 * @param {Truth} truth
 * @param {Plant | null} plant
 * @returns {Difference[]}
 */
export function differences(truth, plant) {
  const [states, parameters] = [unitsOf(plant?.states), unitsOf(plant?.parameters)];
  /** @param {string} kind @param {{[name: string]: string}} args */
  const one = (kind, args) => ({code: `page.truth.is.${kind}`, args});
  const own = new Map(truth.states.map((state) => [state.name, state]));
  return [
    ...(truth.record ? [one('record', {name: truth.record.name || truth.record.id.slice(0, 8)})] : []),
    ...(truth.deviation > 0 ? [one('deviation', {percent: number(100 * truth.deviation)})] : []),
    ...Object.entries(truth.parameters).map(([name, value]) =>
      one('parameter', {name: called(name, null), value: withUnit(value, parameters.get(name))}),
    ),
    ...Object.entries(truth.process_noise)
      .filter(([, std]) => std > 0)
      .map(([name, std]) =>
        one('process-noise', {
          name: called(name, plant),
          std: `${number(std)}\u202f${perRoot(states.get(name) ?? own.get(name)?.unit ?? '')}`,
        }),
      ),
    ...Object.entries(truth.outputs).flatMap(([output, sensor]) => sensorDifferences(output, sensor, plant)),
    ...truth.states.map(({name, initial}) =>
      one('state', {name: called(name, null), text: truth.dynamics[name] ?? '', initial: number(initial)}),
    ),
    ...Object.entries(truth.dynamics)
      .filter(([name]) => !own.has(name))
      .map(([name, text]) => one('dynamics', {name: called(name, null), text})),
  ];
}

/**
 * The differences of one sensor.
 * @param {string} output
 * @param {Partial<service.TrueSensor>} sensor
 * @param {Plant | null} plant
 * @returns {Difference[]}
 */
function sensorDifferences(output, {correlation, period, missing, jitter, adds}, plant) {
  const name = called(output, plant);
  /** @type {[string, {[name: string]: string} | null | false][]} */
  const parts = [
    ['correlation', correlation !== null && correlation !== undefined && {time: number(correlation)}],
    ['period', period !== null && period !== undefined && {time: number(period)}],
    ['missing', Boolean(missing) && {percent: number(100 * (missing ?? 0))}],
    ['jitter', Boolean(jitter) && {time: number(jitter)}],
    ['adds', adds !== null && adds !== undefined && {text: adds}],
  ];
  return parts.flatMap(([kind, args]) => (args ? [{code: `page.truth.is.${kind}`, args: {name, ...args}}] : []));
}

/**
 * The unit of process noise: that of the state per √s.
 * @param {string} unit
 */
export const perRoot = (unit) => `${/[/·*\s]/.test(unit) ? `(${unit})` : unit || '1'}/√s`;

/**
 * How the simulated plant of an experiment differs from the model, in sentences: from the beginning, and at the end
 * where that changed meanwhile.
 * @param {Pick<service.Experiment, 'truth' | 'commands'>} spec
 * @param {Plant | null} plant
 * @returns {string[]}
 */
export function sentences({truth, commands}, plant) {
  const first = differences(complete(truth), plant);
  const changes = commands.flatMap((one) => (one.command === 'set-truth' ? [one] : []));
  const last = differences(complete(changes.at(-1)?.truth), plant);
  return [
    ...(first.length > 0 ? [t('page.truth.sentence', {parts: first})] : []),
    ...(changes.length > 0
      ? [
          t('page.truth.changed', {
            n: changes.length,
            t: number(changes[0].at),
            parts: last.length > 0 ? last : [{code: 'page.truth.none', args: {}}],
          }),
        ]
      : []),
  ];
}

/** @param {{name: string, unit: string}[] | undefined} items */
const unitsOf = (items) => new Map((items ?? []).map((item) => [item.name, item.unit]));

/**
 * @param {number} value
 * @param {string | undefined} unit
 */
const withUnit = (value, unit) => (unit ? `${number(value)}\u202f${unit}` : number(value));
