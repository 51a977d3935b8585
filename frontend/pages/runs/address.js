// The choice stands in the address, so that a link opens it again:
//   ?experiment=zhao-2012&set=seed%3D3&set=noise.y.std%3D0&run=0123…

/** What an address chooses: {experiment, changes, run}. */
export function read(search) {
  const query = new URLSearchParams(search);
  const changes = {};
  for (const assignment of query.getAll('set')) {
    const [path, ...rest] = assignment.split('=');
    if (path.trim() && rest.length) changes[path.trim()] = value(rest.join('='));
  }
  return {experiment: query.get('experiment'), changes, run: query.get('run')};
}

/** The address of a choice. */
export function write({experiment, changes = {}, run = null}) {
  const query = new URLSearchParams();
  if (experiment) query.set('experiment', experiment);
  for (const [path, to] of Object.entries(changes)) query.append('set', `${path}=${spell(to)}`);
  if (run) query.set('run', run);
  const text = query.toString();
  return text ? `?${text}` : '/runs/';
}

/** A typed value: JSON where it is JSON, else text; the server says what is wrong with it. */
export function value(typed) {
  const trimmed = typed.trim();
  if (/^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(trimmed)) return Number(trimmed);
  try {
    return JSON.parse(trimmed);
  } catch {
    return trimmed;
  }
}

/** A value as one types it. */
export function spell(to) {
  return typeof to === 'string' ? to : JSON.stringify(to);
}
