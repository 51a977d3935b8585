// The REST interface. Every refusal becomes a Problem; a server that does not answer is waited for.

/** @import * as service from '../types/service.js' */

/**
 * @typedef {object} Request
 * @property {unknown} [body]   sent as JSON
 * @property {Blob} [raw]   a file, sent as it is in place of a body
 * @property {AbortSignal} [signal]
 * @property {{[name: string]: string}} [headers]
 */

/** A refusal by the server (RFC 9457). */
export class Problem extends Error {
  /** @param {Partial<service.Problem>} problem */
  constructor({title = '', detail = '', status = 0, code = '', args = {}, errors = []}) {
    super(detail || title);
    this.title = title;
    this.detail = detail;
    this.status = status;
    this.code = code;
    this.args = args;
    this.errors = errors;
  }
}

/**
 * The error that was thrown, whatever was thrown.
 * @param {unknown} thrown
 * @returns {Error}
 */
export const reason = (thrown) => (thrown instanceof Error ? thrown : new Error(String(thrown)));

/** Whether the server answers; a `change` event tells when that changes. */
export const connection = Object.assign(new EventTarget(), {lost: false});

/** @param {boolean} lost */
function mark(lost) {
  if (connection.lost === lost) return;
  connection.lost = lost;
  connection.dispatchEvent(new Event('change'));
}

/**
 * @param {number} seconds
 * @param {AbortSignal} [signal]
 * @returns {Promise<void>}
 */
const pause = (seconds, signal) =>
  new Promise((done, stop) => {
    const timer = setTimeout(done, seconds * 1000);
    signal?.addEventListener(
      'abort',
      () => {
        clearTimeout(timer);
        stop(signal.reason);
      },
      {once: true},
    );
  });

/**
 * The answer to a request, as JSON, its sentences in the page's language. Waits for a lost server: every request of
 * this page may be repeated.
 * @template T   type of the answer
 * @param {string} method
 * @param {string} url
 * @param {Request} [options]
 * @returns {Promise<T>}
 * @throws {Problem} where the server refuses it
 */
export async function request(method, url, {body, raw, signal, headers = {}} = {}) {
  const kind = raw ? raw.type || 'application/octet-stream' : body === undefined ? null : 'application/json';
  for (let wait = 0.5; ; wait = Math.min(wait * 1.5, 4)) {
    try {
      const answer = await fetch(url, {
        method,
        signal,
        headers: {
          'Accept-Language': document.documentElement.lang,
          ...(kind === null ? {} : {'Content-Type': kind}),
          ...headers,
        },
        body: raw ?? (body === undefined ? undefined : JSON.stringify(body)),
      });
      mark(false);
      return await read(answer);
    } catch (error) {
      // fetch reports a lost connection as a TypeError
      if (!(error instanceof TypeError) || signal?.aborted) throw error;
      mark(true);
      await pause(wait, signal);
    }
  }
}

/** @param {Response} answer */
async function read(answer) {
  const kind = answer.headers.get('content-type') ?? '';
  if (answer.ok) return kind.includes('json') ? answer.json() : null;
  if (!kind.includes('json'))
    throw new Problem({title: `${answer.status} ${answer.statusText}`, status: answer.status});
  throw new Problem(await answer.json());
}

/**
 * @template T
 * @param {string} url
 * @param {AbortSignal} [signal]
 * @returns {Promise<T>}
 */
export const get = (url, signal) => request('GET', url, {signal});

/**
 * @template T
 * @param {string} url
 * @param {unknown} [body]
 * @param {AbortSignal} [signal]
 * @returns {Promise<T>}
 */
export const post = (url, body, signal) => request('POST', url, {body, signal});

/** @type {Set<service.Run['status']>} */
const ACTIVE = new Set(['queued', 'running']);

/**
 * Start a run and follow it to its end. `progress` receives each state on the way.
 * @param {service.RunRequest | service.ExperimentInput} body
 * @param {(state: service.Run | service.Progress) => void} progress
 * @param {AbortSignal} [signal]
 * @returns {Promise<service.Run>}
 */
export const run = async (body, progress, signal) => follow(await post('/api/runs', body, signal), progress, signal);

/**
 * Follow a run that the server has accepted until it ends: a 202 answer holds its progress, not yet its spec and
 * summary.
 * @param {service.Run | service.Progress} state
 * @param {(state: service.Run | service.Progress) => void} [progress]
 * @param {AbortSignal} [signal]
 * @returns {Promise<service.Run>}
 */
export async function follow(state, progress = () => {}, signal = undefined) {
  while (ACTIVE.has(state.status)) {
    progress(state);
    await pause(0.2, signal);
    state = await get(`${state.links.progress}?wait=0.5`, signal);
  }
  return 'spec' in state ? state : get(state.links.self, signal);
}
