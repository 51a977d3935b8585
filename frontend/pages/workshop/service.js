// The requests of the workshop.

import {get, post, request} from '../../common/api.js';

/** @import * as service from '../../types/service.js' */
/** @import {TextCheck, Trial} from './types.js' */

/** @param {string} text */
const asBody = (text) => new Blob([text], {type: 'application/yaml'});

/**
 * @param {string} text
 * @param {AbortSignal} signal
 * @returns {Promise<TextCheck>}
 */
export const check = (text, signal) => request('POST', '/api/plants/check-text', {raw: asBody(text), signal});

/**
 * @param {string} text
 * @param {object} changes
 * @returns {Promise<service.EditedText>}
 */
export const edit = (text, changes) => post('/api/plants/edit-text', {text, ...changes});

/**
 * @param {service.PlantTrialRequest} body
 * @param {AbortSignal} signal
 * @returns {Promise<Trial>}
 */
export const trial = (body, signal) => request('POST', '/api/plants/trial', {body, signal});

/**
 * @param {service.PlantTrialRequest} body
 * @param {AbortSignal} signal
 * @returns {Promise<service.ObserverRanking>}
 */
export const ranking = (body, signal) => request('POST', '/api/plants/ranking', {body, signal});

/**
 * @param {service.FaultPatternRequest} body
 * @returns {Promise<service.FaultPatterns>}
 */
export const patterns = (body) => post('/api/plants/fault-patterns', body);

/** @param {object} spec @returns {Promise<service.Run | service.Progress>} */
export const run = (spec) => post('/api/runs?wait=0', spec);

/** @returns {Promise<service.MyPlantList>} */
export const mine = () => get('/api/my-plants');

/** @param {string} id @param {number} [version] @returns {Promise<service.MyPlant>} */
export const open = (id, version) =>
  get(`/api/my-plants/${encodeURIComponent(id)}${version ? `?version=${version}` : ''}`);

/** @param {string} id @returns {Promise<service.MyPlantList>} */
export const versions = (id) => get(`/api/my-plants/${encodeURIComponent(id)}/versions`);

/** @param {string} id @param {string} text @returns {Promise<service.MyPlant>} */
export const save = (id, text) => request('PUT', `/api/my-plants/${encodeURIComponent(id)}`, {raw: asBody(text)});

/** @param {string} id */
export const remove = (id) => request('DELETE', `/api/my-plants/${encodeURIComponent(id)}`);

/** @param {string} id @returns {Promise<service.MyPlant>} */
export const restore = (id) => post(`/api/my-plants/${encodeURIComponent(id)}/restore`);

/** @param {string} id @returns {Promise<service.EditedText>} */
export const libraryText = (id) => get(`/api/plants/${encodeURIComponent(id)}/text`);
