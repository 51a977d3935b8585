// The requests of the page: a record is uploaded, mapped, drawn and diagnosed.

import {get, post, request} from '../../common/api.js';

/** @import * as service from '../../types/service.js' */
/** @import {Inspection, Mapping, Plant, PlantChoice, Preview, Settings} from './types.js' */

const SHOWN = 'friction-motor'; // a plant whose record shows a fault
const INTERVALS = 700; // of a preview; more than the picture has pixels would not be seen

/** @param {string} id */
const address = (id) => `/api/records/${encodeURIComponent(id)}`;

/**
 * @param {File} file
 * @param {AbortSignal} signal
 * @returns {Promise<Inspection>}
 */
export const upload = (file, signal) =>
  request('POST', `/api/records?name=${encodeURIComponent(file.name)}`, {raw: file, signal});

/** @param {string} id @param {AbortSignal} signal @returns {Promise<Inspection>} */
export const stored = (id, signal) => get(address(id), signal);

/**
 * @param {string} id
 * @param {{plant: PlantChoice, mapping?: Mapping}} body
 * @param {AbortSignal} signal
 * @returns {Promise<Inspection>}
 */
export const inspect = (id, body, signal) => post(`${address(id)}/mapping`, body, signal);

/**
 * The curves with the plant and the mapping that were sent last.
 * @param {string} id
 * @param {AbortSignal} signal
 * @returns {Promise<Preview>}
 */
export const preview = (id, signal) => get(`${address(id)}/preview?intervals=${INTERVALS}`, signal);

/**
 * @param {string} id
 * @param {{plant: PlantChoice, mapping?: Mapping, settings: Settings}} body
 * @param {AbortSignal} signal
 * @returns {Promise<service.RecordDiagnosis>}
 */
export const diagnose = (id, body, signal) => post(`${address(id)}/diagnosis`, body, signal);

/**
 * @param {string} id
 * @param {{plant: PlantChoice, mapping?: Mapping, settings: Settings}} body
 * @param {AbortSignal} signal
 * @returns {Promise<{report: service.FitReport, plant: Plant}>}
 */
export const fit = (id, body, signal) => post(`${address(id)}/fit`, body, signal);

/**
 * A plant written as YAML or JSON.
 * @param {string} text
 * @param {AbortSignal} signal
 * @returns {Promise<Plant>}
 */
export const readPlant = (text, signal) =>
  request('POST', '/api/plants/read', {raw: new Blob([text], {type: 'text/plain'}), signal});

/**
 * A run of an experiment as a file, for those who have no record of their own: of the plant, or of the one shown first.
 * @param {string | null} plant
 * @param {AbortSignal} signal
 * @returns {Promise<{file: File, experiment: string, plant: string}>}
 */
export async function simulated(plant, signal) {
  /** @type {service.ExperimentList} */
  const {experiments} = await get('/api/experiments', signal);
  const own = experiments.filter((one) => one.plant === (plant ?? SHOWN));
  const {id, plant: of} = own.find((one) => one.observers.length > 0) ?? own[0] ?? experiments[0];
  const [run, {inputs, signals, outputs}] = await Promise.all([
    /** @type {Promise<service.Run>} */ (
      post('/api/runs?wait=60', {experiment: id, set: {observers: [], figures: []}}, signal)
    ),
    /** @type {Promise<Plant>} */ (get(`/api/plants/${encodeURIComponent(of)}`, signal)),
  ]);
  const columns = [
    't',
    ...inputs.map((one) => `u.${one.name}`),
    ...signals.map((one) => `signal.${one.name}`),
    ...outputs.map((one) => `y.${one.name}`),
  ];
  const answer = await fetch(`/api/runs/${run.id}/data?format=csv&columns=${columns.join(',')}`, {signal});
  return {file: new File([await answer.text()], `${id}.csv`, {type: 'text/csv'}), experiment: id, plant: of};
}
