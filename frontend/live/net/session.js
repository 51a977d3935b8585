// Sessions over REST, and what this tab remembers of the one that it began.

import {get, post, Problem, request} from '../../common/api.js';

const KEPT = 'thetascope.sessions';
const MOST = 8; // sessions that are remembered

/** Begin a session. `play`: time runs at once; `t`: begin at that time. */
export const create = (body) => post('/api/sessions', body);

/** How a session stands, or null where there is none (any more). */
export async function look(id) {
  try {
    return await get(`/api/sessions/${encodeURIComponent(id)}`);
  } catch (error) {
    if (error instanceof Problem && error.status === 404) return null;
    throw error;
  }
}

const controlled = (method, id, what, token, body) =>
  request(method, `/api/sessions/${encodeURIComponent(id)}${what}`, {
    body,
    headers: token ? {'X-Control-Token': token} : {},
  });

export const fork = (id, token, t) => controlled('POST', id, '/fork', token, t === undefined ? {} : {t});
export const save = (id, token) => controlled('POST', id, '/save', token, {});
export const end = (id, token) => controlled('DELETE', id, '', token);

const asked = new Map();

/** An experiment of the library with its plant in full. */
export function library(id) {
  if (!asked.has(id)) {
    const whole = (async () => {
      const spec = await get(`/api/experiments/${encodeURIComponent(id)}`);
      return {
        ...spec,
        plant: typeof spec.plant === 'string' ? await get(`/api/plants/${encodeURIComponent(spec.plant)}`) : spec.plant,
      };
    })();
    whole.catch(() => asked.delete(id));
    asked.set(id, whole);
  }
  return asked.get(id);
}

/** What this tab controls, {id, token, address, experiment, plain, parent}, so that loading the page again and going back in it do not lose it; the newest last. */
export const kept = {
  all() {
    try {
      return JSON.parse(sessionStorage.getItem(KEPT)) ?? [];
    } catch {
      return [];
    }
  },
  /** The one that was shown last. */
  read: () => kept.all().at(-1) ?? null,
  of: (id) => kept.all().find((one) => one.id === id) ?? null,
  /** The newest that was forked from a session. */
  forkOf: (id) => kept.all().findLast((one) => one.parent?.id === id) ?? null,
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
