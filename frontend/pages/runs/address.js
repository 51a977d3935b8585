// The address holds the choice, so that a link opens it again:
//   ?experiment=zhao-2012&set=seed%3D3&set=noise.y.std%3D0&run=0123…

/**
 * A library experiment, the fields that are changed in it, and the run that is shown.
 * @typedef {object} Choice
 * @property {string | null} experiment
 * @property {{[path: string]: unknown}} [changes]
 * @property {string | null} [run]
 */

/**
 * The choice that an address holds.
 * @param {string} search
 * @returns {Required<Choice>}
 */
export function read(search) {
  const query = new URLSearchParams(search);
  /** @type {{[path: string]: unknown}} */
  const changes = {};
  for (const assignment of query.getAll('set')) {
    const [path, ...rest] = assignment.split('=');
    if (path.trim() && rest.length) changes[path.trim()] = value(rest.join('='));
  }
  return {experiment: query.get('experiment'), changes, run: query.get('run')};
}

/**
 * The address of a choice.
 * @param {Choice} choice
 */
export function write({experiment, changes = {}, run = null}) {
  const query = new URLSearchParams();
  if (experiment) query.set('experiment', experiment);
  for (const [path, to] of Object.entries(changes)) query.append('set', `${path}=${asTyped(to)}`);
  if (run) query.set('run', run);
  const text = query.toString();
  return text ? `?${text}` : '/runs/';
}

/**
 * The value of typed text: a number or JSON where it reads as one, else the text itself.
 * @param {string} typed
 * @returns {unknown}
 */
export function value(typed) {
  const trimmed = typed.trim();
  if (/^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(trimmed)) return Number(trimmed);
  try {
    return JSON.parse(trimmed);
  } catch {
    return trimmed;
  }
}

/**
 * A value as one types it.
 * @param {unknown} to
 * @returns {string}
 */
export function asTyped(to) {
  return typeof to === 'string' ? to : JSON.stringify(to);
}
