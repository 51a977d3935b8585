// The signals of a session: which ones can be moved, and the one that is in force at a time.

/** @import {Experiment, Plant} from '../../types.js' */
/** @import {Signal} from '../../../widgets/signal/shapes.js' */

/**
 * An input, a set point or a known signal.
 * @typedef {object} Item
 * @property {string} name
 * @property {'input' | 'reference' | 'signal'} kind
 * @property {string} column              of its values in the samples
 * @property {string} unit
 * @property {[number | null, number | null]} bounds
 * @property {Plant['inputs'][number]['description']} description
 * @property {string | null} controller   that sets it; null: it can be moved
 * @property {Signal} usual               in force where the experiment gives none
 */

/**
 * Set points, inputs and known signals of a plant, those that can be moved first.
 * @param {Plant} plant
 * @returns {Item[]}
 */
export function itemsOf(plant) {
  const by = new Map((plant.controllers ?? []).flatMap((one) => one.outputs.map(({input}) => [input, one.name])));
  const references = (plant.references ?? []).map((one) => item(one, 'reference', 'r', null));
  const inputs = plant.inputs.map((one) => item(one, 'input', 'u', by.get(one.name) ?? null));
  /** @type {Item[]} */
  const signals = plant.signals.map(({name, unit, description, default: usual}) => ({
    name,
    kind: 'signal',
    column: `signal.${name}`,
    unit,
    bounds: [null, null],
    description,
    controller: null,
    usual,
  }));
  const all = [...references, ...inputs, ...signals];
  return [...all.filter(({controller}) => controller === null), ...all.filter(({controller}) => controller !== null)];
}

/**
 * @param {Pick<Plant['inputs'][number], 'name' | 'unit' | 'bounds' | 'description' | 'default'>} one
 * @param {'input' | 'reference'} kind
 * @param {string} prefix
 * @param {string | null} controller
 * @returns {Item}
 */
const item = ({name, unit, bounds, description, default: value}, kind, prefix, controller) => ({
  name,
  kind,
  column: `${prefix}.${name}`,
  unit,
  bounds: [bounds[0] ?? null, bounds[1] ?? null],
  description,
  controller,
  usual: {kind: 'constant', value},
});

/**
 * The signal that is in force at a time: by the last command up to then, else by the experiment.
 * @param {Pick<Experiment, 'inputs' | 'signals' | 'commands'>} spec
 * @param {Item} item
 * @param {number} t   s
 * @returns {Signal}
 */
export function presentSignal(spec, {name, kind, usual}, t) {
  for (let k = spec.commands.length - 1; k >= 0; k -= 1) {
    const command = spec.commands[k];
    if (command.command === 'set-signal' && command.name === name && command.at <= t) return command.signal;
  }
  return (kind === 'signal' ? spec.signals : spec.inputs)[name] ?? usual;
}

/**
 * The values that sliders offer: the bounds of the item, else a range around what it has been.
 * @param {Item} item
 * @param {{min: number, max: number}} seen   least and greatest value so far
 * @returns {{low: number, high: number}}
 */
export function rangeOf({bounds: [low, high], usual}, {min, max}) {
  if (low !== null && high !== null) return {low, high};
  const known = [min, max, usual.kind === 'constant' ? usual.value : NaN].filter(Number.isFinite);
  const [least, most] = known.length ? [Math.min(...known), Math.max(...known)] : [0, 0];
  const room = Math.max(most - least, 0.5 * Math.max(Math.abs(least), Math.abs(most))) || 1;
  return {low: low ?? least - room, high: high ?? most + room};
}
