// Changes of a truth: each returns another truth, in which nothing is named that is as in the model.

import {complete} from '../../../widgets/truth-differences.js';

/** @import {Experiment, Plant} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */

/** @typedef {service.Truth} Truth */
/** @typedef {(truth: Truth) => Truth} Edit */
/** @typedef {keyof service.TrueSensor} SensorField */

/** @type {service.TrueSensor} */
const AS_MODELLED = {correlation: null, period: null, missing: 0, jitter: 0, adds: null};

/**
 * A copy with a value under a name; without that name where the value is undefined.
 * @template T
 * @param {{[name: string]: T}} map
 * @param {string} name
 * @param {T | undefined} value
 * @returns {{[name: string]: T}}
 */
function withEntry(map, name, value) {
  const {[name]: _, ...rest} = map;
  if (value === undefined) return rest;
  return name in map ? {...map, [name]: value} : {...rest, [name]: value};
}

/** @param {number} share @returns {Edit} */
export const setDeviation = (share) => (truth) => ({...truth, deviation: share});

/**
 * The true value of a parameter. The model's value is named, too, where the parameters that are not named differ.
 * @param {string} name
 * @param {number | null} value   null: as the others
 * @param {number} model          the value in the model
 * @returns {Edit}
 */
export const setParameter = (name, value, model) => (truth) => ({
  ...truth,
  parameters: withEntry(
    truth.parameters,
    name,
    value === null || (value === model && truth.deviation === 0) ? undefined : value,
  ),
});

/** @param {string} name @param {number} std @returns {Edit} */
export const setProcessNoise = (name, std) => (truth) => ({
  ...truth,
  process_noise: withEntry(truth.process_noise, name, std > 0 ? std : undefined),
});

/**
 * The sensor of an output in a truth, with all its fields.
 * @param {Truth} truth
 * @param {string} output
 * @returns {service.TrueSensor}
 */
export const sensorOf = (truth, output) => ({...AS_MODELLED, ...truth.outputs[output]});

/**
 * A field of a sensor. Samples are never later than the next one: a shorter period shortens the jitter.
 * @param {string} output
 * @param {SensorField} field
 * @param {number | string | null} value
 * @param {number} step   s
 * @returns {Edit}
 */
export const setSensor = (output, field, value, step) => (truth) => {
  const sensor = {...sensorOf(truth, output), [field]: value};
  if (field === 'period' && sensor.period !== null && sensor.jitter >= sensor.period)
    sensor.jitter = onGrid(sensor.period - step, step);
  const differs = /** @type {SensorField[]} */ (Object.keys(AS_MODELLED)).some(
    (key) => sensor[key] !== AS_MODELLED[key],
  );
  return {...truth, outputs: withEntry(truth.outputs, output, differs ? sensor : undefined)};
};

/**
 * An expression that is added to the equation of a state, or the equation of a further state.
 * @param {string} name
 * @param {string} text
 * @returns {Edit}
 */
export const setDynamics = (name, text) => (truth) => ({
  ...truth,
  dynamics: withEntry(
    truth.dynamics,
    name,
    text.trim() === '' && !truth.states.some((state) => state.name === name) ? undefined : text.trim(),
  ),
});

/** @param {string} name @returns {Edit} */
export const addState = (name) => (truth) => ({
  ...truth,
  states: [...truth.states, {name, initial: 0, unit: '', description: ''}],
  dynamics: {...truth.dynamics, [name]: ''},
});

/** @param {string} name @returns {Edit} */
export const removeState = (name) => (truth) => ({
  ...truth,
  states: truth.states.filter((state) => state.name !== name),
  dynamics: withEntry(truth.dynamics, name, undefined),
  process_noise: withEntry(truth.process_noise, name, undefined),
});

/**
 * Other values of a further state; its equation and its noise follow its name.
 * @param {string} name
 * @param {Partial<service.TrueState>} values
 * @returns {Edit}
 */
export const changeState = (name, values) => (truth) => {
  const next = values.name ?? name;
  /** @template T @param {{[name: string]: T}} map */
  const renamed = (map) => Object.fromEntries(Object.entries(map).map(([key, to]) => [key === name ? next : key, to]));
  return {
    ...truth,
    states: truth.states.map((state) => (state.name === name ? {...state, ...values} : state)),
    dynamics: renamed(truth.dynamics),
    process_noise: renamed(truth.process_noise),
  };
};

/**
 * The first name of z, z2, z3 … that neither the plant nor the truth has.
 * @param {Plant} plant
 * @param {Truth} truth
 */
export function freeName(plant, truth) {
  const taken = new Set(
    [
      ...plant.states,
      ...plant.inputs,
      ...plant.outputs,
      ...plant.parameters,
      ...plant.signals,
      ...plant.channels,
      ...plant.definitions,
      ...(plant.algebraic ?? []),
      ...(plant.references ?? []),
      ...truth.states,
    ].map(({name}) => name),
  );
  for (let place = 1; ; place += 1) {
    const name = place === 1 ? 'z' : `z${place}`;
    if (!taken.has(name)) return name;
  }
}

/** @param {unknown} value @returns {string} */
const text = (value) =>
  JSON.stringify(value, (_, one) =>
    one && typeof one === 'object' && !Array.isArray(one)
      ? Object.fromEntries(Object.entries(one).sort(([a], [b]) => (a < b ? -1 : 1)))
      : one,
  );

/** @param {Truth} a @param {Truth} b */
export const same = (a, b) => text(a) === text(b);

/** Whether two truths have the same further states: only then can one follow the other while time runs. */
/** @param {Truth} a @param {Truth} b */
export const sameStates = (a, b) => text(a.states) === text(b.states);

/**
 * The experiment with another truth from its beginning: faults and other commands stay, changes of the truth do not.
 * @param {Experiment} spec
 * @param {Truth} truth
 * @returns {Experiment}
 */
export const withTruth = (spec, truth) => ({
  ...spec,
  truth,
  commands: spec.commands.filter(({command}) => command !== 'set-truth'),
});

/**
 * The truth from the beginning of an experiment on.
 * @param {Pick<service.Experiment, 'truth'> | null} spec
 */
export const firstTruth = (spec) => complete(spec?.truth);

/**
 * The nearest multiple of a step, without the noise of floating point.
 * @param {number} value
 * @param {number} step
 */
export const onGrid = (value, step) => Number((Math.round(value / step) * step).toPrecision(12));

/**
 * The element whose value a refusal is about, by its path within the truth: "dynamics.z", "states.0.name".
 * @param {{field?: string, value?: unknown}} refusal
 */
export function pathOf({field = '', value}) {
  const path = field.replace(/^.*?\btruth\.?/, '').replace(/\[(\d+)\]/g, '.$1');
  return path === 'dynamics' && typeof value === 'string' ? `dynamics.${value}` : path;
}
