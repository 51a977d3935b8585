// Which runs are shown and how: in the address, so that a link or the Back button shows the same again.

/**
 * @typedef {object} Filter
 * @property {string} q   words and conditions
 * @property {string} kind   run, session or record; empty: all
 * @property {string} tag
 * @property {boolean} pinned
 * @property {string} since   today, week, month or any
 * @property {string} sort   a column
 * @property {boolean} descending
 * @property {string} group   none, experiment or tags
 */

/** @type {Filter} */
export const NO_FILTER = {
  q: '',
  kind: '',
  tag: '',
  pinned: false,
  since: 'any',
  sort: 'created',
  descending: true,
  group: 'experiment',
};

const DAYS = /** @type {{[since: string]: number}} */ ({today: 0, week: 7, month: 30});

/** The spans of time that can be chosen. */
export const SPANS = Object.keys(DAYS);

/**
 * The filter that an address holds.
 * @param {string} search
 * @returns {Filter}
 */
export function readFilter(search) {
  const query = new URLSearchParams(search);
  /** @type {Filter} */
  const filter = {...NO_FILTER};
  for (const name of /** @type {const} */ (['q', 'kind', 'tag', 'since', 'sort', 'group']))
    filter[name] = query.get(name) ?? filter[name];
  filter.pinned = query.has('pinned');
  filter.descending = query.has('descending') ? query.get('descending') === 'true' : filter.sort === 'created';
  return filter;
}

/**
 * The address of a filter: only what differs from the usual.
 * @param {Filter} filter
 */
export function addressOf(filter) {
  const query = new URLSearchParams();
  for (const name of /** @type {const} */ (['q', 'kind', 'tag', 'since', 'sort', 'group']))
    if (filter[name] !== NO_FILTER[name]) query.set(name, filter[name]);
  if (filter.pinned) query.set('pinned', '');
  if (filter.descending !== (filter.sort === 'created')) query.set('descending', String(filter.descending));
  const text = query.toString();
  return text ? `?${text}` : '/runs/';
}

/**
 * The request for a page of the runs that a filter shows.
 * @param {Filter} filter
 * @param {number} limit
 * @param {number} offset
 * @param {Date} [today]
 */
export function requestOf(filter, limit, offset, today = new Date()) {
  const query = new URLSearchParams({limit: String(limit), offset: String(offset)});
  for (const name of /** @type {const} */ (['q', 'kind', 'tag'])) if (filter[name]) query.set(name, filter[name]);
  for (const name of /** @type {const} */ (['sort', 'group'])) query.set(name, filter[name]);
  query.set('descending', String(filter.descending));
  if (filter.pinned) query.set('pinned', 'true');
  if (Object.hasOwn(DAYS, filter.since)) {
    const from = new Date(today.getFullYear(), today.getMonth(), today.getDate() - DAYS[filter.since]);
    query.set('since', String(from.getTime() / 1000));
  }
  return `/api/runs?${query}`;
}
