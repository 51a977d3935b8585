// The requests of the page: a record is uploaded, mapped, drawn and diagnosed.

import {Problem, get, post, request} from '../../common/api.js';

/** @import * as service from '../../types/service.js' */
/** @import {Columns, Inspection, Mapping, Plant, PlantChoice, Preview, RecordRun, Settings} from './types.js' */

const SHOWN = 'friction-motor'; // a plant whose record shows a fault
const MOST_COMPARED = 12; // stored runs
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
 * Run observers on a record, and wait for the end.
 * @param {string} id
 * @param {{plant: PlantChoice, mapping?: Mapping, settings: Settings, observers: readonly unknown[]}} body
 * @param {AbortSignal} signal
 * @returns {Promise<RecordRun>}
 */
export async function observe(id, body, signal) {
  /** @type {service.Run} */
  let run = await post(`${address(id)}/runs?wait=20`, body, signal);
  while (run.status === 'queued' || run.status === 'running') {
    await get(`/api/runs/${run.id}/progress?wait=20`, signal);
    run = await get(`/api/runs/${run.id}`, signal);
  }
  if (run.status !== 'done') throw new Problem(run.problem ?? {title: run.status});
  return recordRun(run, signal);
}

/** @param {service.Run} run @param {AbortSignal} signal @returns {Promise<RecordRun>} */
async function recordRun(run, signal) {
  const labels = run.spec.observers.map(({label}) => label);
  const wanted = ['t', 'y.*', ...labels.flatMap((one) => [`${one}.theta.*`, `${one}.sigma.*`, `${one}.y.*`])];
  const summary = await Promise.all(wanted.map((one) => columnsOf(run.id, one, signal)));
  const columns = /** @type {Columns} */ (Object.assign({}, ...summary));
  return {id: run.id, labels, spec: run.spec, links: run.links, columns, shown: true};
}

/**
 * Columns by a pattern, thinned; none for a pattern that no column matches.
 * @param {string} run
 * @param {string} pattern
 * @param {AbortSignal} signal
 */
async function columnsOf(run, pattern, signal) {
  const query = new URLSearchParams({format: 'json', points: String(INTERVALS), columns: pattern});
  try {
    return (await get(`/api/runs/${run}/data?${query}`, signal)).columns;
  } catch (error) {
    if (error instanceof Problem && error.status === 422) return {};
    throw error;
  }
}

/**
 * Earlier runs on a record, with the names of its file.
 * @param {string} id
 * @param {string} name
 * @param {AbortSignal} signal
 * @returns {Promise<RecordRun[]>}
 */
export async function storedRuns(id, name, signal) {
  /** @type {service.RunList} */
  const {runs} = await get('/api/runs?limit=200', signal);
  const named = runs.filter(({title, status}) => title === name && status === 'done').slice(0, MOST_COMPARED);
  const whole = await Promise.all(
    named.map((one) => /** @type {Promise<service.Run>} */ (get(`/api/runs/${one.id}`, signal))),
  );
  const own = whole.filter(({spec}) => spec.truth?.record?.id === id);
  const known = await Promise.all(own.map((one) => recordRun(one, signal)));
  return known.map((one) => ({...one, shown: false}));
}

/** @param {string} id @param {AbortSignal} signal @returns {Promise<Plant | null>} */
export const plantOf = (id, signal) => get(`${address(id)}/plant`, signal);

/**
 * The latest version of a plant that was saved.
 * @param {string} id
 * @param {AbortSignal} signal
 * @returns {Promise<Plant>}
 */
export async function saved(id, signal) {
  const {text} = await get(`/api/my-plants/${encodeURIComponent(id)}`, signal);
  return readPlant(text, signal);
}

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
