// The plants that were saved in the workshop, wherever a plant or an experiment is chosen.

import {get, post} from '../common/api.js';

/** @import * as service from '../types/service.js' */

const COMPARED = 2; // observers in an experiment on a saved plant

/**
 * The saved plants that can be simulated, the one that was saved last first; none where they cannot be listed.
 * @returns {Promise<service.MyPlantLine[]>}
 */
export async function ownPlants() {
  try {
    /** @type {service.MyPlantList} */
    const {plants} = await get('/api/my-plants');
    return plants.filter((plant) => plant.ready);
  } catch {
    return [];
  }
}

/**
 * An experiment on a saved plant: the one that suits it, with the two best observers; `fault`: the first one begins in
 * the middle.
 * @param {string} plant
 * @param {{fault?: boolean}} [options]
 * @returns {Promise<service.ExperimentInput>}
 */
export async function experimentOn(plant, {fault = false} = {}) {
  const [{experiment, preview}, {observers}] = await Promise.all([
    /** @type {Promise<service.PlantTrial>} */ (post('/api/plants/trial', {plant})),
    /** @type {Promise<service.ObserverRanking>} */ (post('/api/plants/ranking', {plant})),
  ]);
  const best = observers.filter((one) => one.possible).slice(0, COMPARED);
  const [channel, size] = Object.entries(preview.sizes)[0] ?? [];
  const faults = fault && channel ? [{channel, shape: /** @type {const} */ ('step'), onset: preview.onset, size}] : [];
  return /** @type {service.ExperimentInput} */ ({
    ...experiment,
    observers: best.map(({kind}) => ({label: kind, kind})),
    faults,
  });
}
