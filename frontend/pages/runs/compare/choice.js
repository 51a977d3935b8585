// What is compared, in the address: the runs, the observer, and whether curves are less the first.

/**
 * @typedef {object} Choice
 * @property {string[]} ids
 * @property {string} observer   label; empty: the first of each run
 * @property {boolean} less   whether curves are the differences from the first run
 */

/** @param {string} search @returns {Choice} */
export function readChoice(search) {
  const query = new URLSearchParams(search);
  return {
    ids: (query.get('compare') ?? '').split(',').filter(Boolean),
    observer: query.get('observer') ?? '',
    less: query.has('less'),
  };
}

/** The address of a comparison; of a single run, that of the notebook. @param {Choice} choice */
export function addressOf({ids, observer, less}) {
  if (ids.length < 2) return '/runs/';
  const more = `${observer && `&observer=${encodeURIComponent(observer)}`}${less ? '&less' : ''}`;
  return `/runs/?compare=${ids.join(',')}${more}`;
}

/** The query of a request to the server. @param {Choice} choice */
export function queryOf({ids, observer, less}) {
  const query = new URLSearchParams({ids: ids.join(',')});
  if (observer) query.set('observer', observer);
  if (less) query.set('less', 'true');
  return query;
}

/**
 * The arguments of the dialog for a figure for a paper.
 * @param {Choice} choice
 * @param {string} title
 * @returns {[string, string, number[], URLSearchParams]}
 */
export const paperOf = (choice, title) => ['/api/runs/compare/figure', title, [], queryOf(choice)];
