// Sessions over REST, and the sessions that this tab remembers.

import {follow, get, post, Problem, request} from '../../common/api.js';

/** @import {Experiment, KeptSession, Run} from '../types.js' */
/** @import * as service from '../../types/service.js' */

const KEPT = 'thetascope.sessions';
const MOST = 8; // sessions that are remembered

/**
 * Begin a session. `play`: time runs from the start; `t`: begin at that time.
 * @param {service.SessionRequest} body
 * @returns {Promise<service.SessionOpened>}
 */
export const create = (body) => post('/api/sessions', body);

/**
 * The state of a session, or null if it does not exist (any more).
 * @param {string} id
 * @returns {Promise<service.SessionState | null>}
 */
export async function look(id) {
  try {
    return await get(`/api/sessions/${encodeURIComponent(id)}`);
  } catch (error) {
    if (error instanceof Problem && error.status === 404) return null;
    throw error;
  }
}

/**
 * @template T
 * @param {string} method
 * @param {string} id
 * @param {string} path
 * @param {string | null} token
 * @param {unknown} [body]
 * @returns {Promise<T>}
 */
const controlled = (method, id, path, token, body) =>
  request(method, `/api/sessions/${encodeURIComponent(id)}${path}`, {
    body,
    headers: token ? {'X-Control-Token': token} : {},
  });

/**
 * @param {string} id
 * @param {string | null} token
 * @param {number | undefined} t
 * @returns {Promise<service.SessionOpened>}
 */
export const fork = (id, token, t) => controlled('POST', id, '/fork', token, t === undefined ? {} : {t});

/**
 * Save a session as a run. The promise settles when the run has ended, and rejects with a Problem where it has no
 * result.
 * @param {string} id
 * @param {string | null} token
 * @returns {Promise<service.Run>}
 */
export async function save(id, token) {
  const run = await follow(await controlled('POST', id, '/save', token, {}));
  if (run.status !== 'done') throw new Problem(run.problem ?? {title: run.status});
  return run;
}

/**
 * @param {string} id
 * @param {string | null} token
 * @returns {Promise<null>}
 */
export const end = (id, token) => controlled('DELETE', id, '', token);

/** @type {Map<string, Promise<Experiment>>} */
const requested = new Map();

/**
 * An experiment of the library with its plant in full.
 * @param {string} id
 * @returns {Promise<Experiment>}
 */
export function library(id) {
  const known = requested.get(id);
  if (!known) {
    const whole = (async () => {
      /** @type {service.Experiment} */
      const spec = await get(`/api/experiments/${encodeURIComponent(id)}?lang=*`);
      /** @type {service.Plant} */
      const plant =
        typeof spec.plant === 'string' ? await get(`/api/plants/${encodeURIComponent(spec.plant)}?lang=*`) : spec.plant;
      return {...spec, plant};
    })();
    whole.catch(() => requested.delete(id));
    requested.set(id, whole);
    return whole;
  }
  return known;
}

/**
 * What this tab controls, {id, token, address, experiment, plain, parent}, so that loading the page again and going
 * back in it do not lose it; the newest last.
 */
export const kept = {
  /** @returns {KeptSession[]} */
  all() {
    try {
      return JSON.parse(sessionStorage.getItem(KEPT) ?? '[]');
    } catch {
      return [];
    }
  },
  /** The one that was shown last. */
  read: () => kept.all().at(-1) ?? null,
  /** @param {string} id */
  /** @param {string} id */
  of: (id) => kept.all().find((one) => one.id === id) ?? null,
  /**
   * The newest that was forked from a session.
   * @param {string | null} id
   * @returns {KeptSession | null}
   */
  forkOf: (id) => kept.all().findLast((one) => one.parent?.id === id) ?? null,
  /** @param {KeptSession} value */
  write(value) {
    try {
      sessionStorage.setItem(
        KEPT,
        JSON.stringify([...kept.all().filter(({id}) => id !== value.id), value].slice(-MOST)),
      );
    } catch {
      /* private windows keep nothing */
    }
  },
};
