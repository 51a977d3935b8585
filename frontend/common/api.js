// The REST interface. Every refusal becomes a Problem; a server that does not answer is waited for.

/** A refusal as the server words it (RFC 9457). */
export class Problem extends Error {
  constructor({title = '', detail = '', status = 0, errors = []}) {
    super(detail || title);
    Object.assign(this, {title, detail, status, errors});
  }
}

/** Whether the server answers; a `change` event tells when that changes. */
export const connection = Object.assign(new EventTarget(), {lost: false});

function mark(lost) {
  if (connection.lost === lost) return;
  connection.lost = lost;
  connection.dispatchEvent(new Event('change'));
}

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

/** The answer to a request, as JSON. Waits for a lost server: every request of this page may be repeated. */
export async function request(method, url, {body, signal, headers = {}} = {}) {
  for (let wait = 0.5; ; wait = Math.min(wait * 1.5, 4)) {
    try {
      const answer = await fetch(url, {
        method,
        signal,
        headers: body === undefined ? headers : {'Content-Type': 'application/json', ...headers},
        body: body === undefined ? undefined : JSON.stringify(body),
      });
      mark(false);
      return await read(answer);
    } catch (error) {
      if (!(error instanceof TypeError) || signal?.aborted) throw error; // fetch reports a lost connection as a TypeError
      mark(true);
      await pause(wait, signal);
    }
  }
}

async function read(answer) {
  const kind = answer.headers.get('content-type') ?? '';
  if (answer.ok) return kind.includes('json') ? answer.json() : null;
  if (!kind.includes('json'))
    throw new Problem({title: `${answer.status} ${answer.statusText}`, status: answer.status});
  throw new Problem(await answer.json());
}

export const get = (url, signal) => request('GET', url, {signal});
export const post = (url, body, signal) => request('POST', url, {body, signal});

const ACTIVE = new Set(['queued', 'running']);

/** Start a run and follow it: `progress` is told each state of it; the answer is the run at its end. */
export async function run(body, progress, signal) {
  let state = await post('/api/runs', body, signal);
  while (ACTIVE.has(state.status)) {
    progress(state);
    await pause(0.2, signal);
    state = await get(`${state.links.progress}?wait=0.5`, signal);
  }
  return 'spec' in state ? state : get(state.links.self, signal);
}
