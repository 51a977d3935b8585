// The experiment that a study repeats: of the library, on a saved plant, or that of a run.

import {get} from '../../common/api.js';
import {experimentOn} from '../../widgets/own-plants.js';

/** @import * as service from '../../types/service.js' */

/** What the choice of a saved plant begins with. */
export const OWN = 'my:';

/**
 * An experiment that was chosen, and the parameters of its plant.
 * @param {string | service.Experiment} chosen   the id of one of the library, a saved plant, or one in full
 * @returns {Promise<{spec: service.Experiment, parameters: string[]}>}
 */
export async function factsOf(chosen) {
  /** @type {service.Experiment} */
  let spec;
  if (typeof chosen !== 'string') spec = chosen;
  else if (chosen.startsWith(OWN)) spec = await completed(chosen.slice(OWN.length));
  else spec = await get(`/api/experiments/${encodeURIComponent(chosen)}`);
  if (typeof spec.plant !== 'string') return {spec, parameters: spec.plant.parameters.map((one) => one.name)};
  try {
    /** @type {service.Plant} */
    const plant = await get(`/api/plants/${encodeURIComponent(spec.plant)}`);
    return {spec, parameters: plant.parameters.map((one) => one.name)};
  } catch {
    return {spec, parameters: []}; // a saved plant: its parameters can be written, but not chosen
  }
}

/**
 * The experiment that suits a saved plant, with a fault.
 * @param {string} plant
 * @returns {Promise<service.Experiment>}
 */
async function completed(plant) {
  const made = await experimentOn(plant, {fault: true});
  return /** @type {service.Experiment} */ ({noise: {}, faults: [], observers: [], parameters: {}, ...made});
}

/** The experiment of a run. @param {string} id @returns {Promise<service.Experiment>} */
export async function specOfRun(id) {
  /** @type {service.Run} */
  const {spec} = await get(`/api/runs/${encodeURIComponent(id)}`);
  return spec;
}

/**
 * Each of some faults alone, and in pairs if wanted, as steps of their sizes.
 * @param {readonly service.Experiment['faults'][number][]} steps
 * @param {boolean} pairs
 * @returns {service.FaultsFactor}
 */
export function faultsAlone(steps, pairs) {
  /** @type {{[channel: string]: number}} */
  const sizes = {};
  for (const one of steps) if ('channel' in one && 'size' in one) sizes[one.channel] = one.size;
  const onset = Math.min(...steps.map((one) => one.onset));
  return {kind: 'faults', name: 'fault', sizes, onset, end: null, pairs};
}
