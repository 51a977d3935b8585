// Texts that were typed and not saved, kept in this browser under the plant that was opened.

/** @import {Source} from './types.js' */

const KEY = 'thetascope.workshop';
const MOST = 20;

/** @returns {{[place: string]: {text: string, time: number, base: string}}} */
function all() {
  try {
    const found = JSON.parse(localStorage.getItem(KEY) ?? '{}');
    return found && typeof found === 'object' ? found : {};
  } catch {
    return {};
  }
}

/** @param {Pick<Source, 'kind' | 'id'>} source */
const placeOf = ({kind, id}) => `${kind}/${id}`;

/**
 * Keep a text; without changes nothing is kept.
 * @param {Source} source
 * @param {string} text
 * @returns {number | null} the time in ms
 */
export function keep(source, text) {
  const drafts = all();
  delete drafts[placeOf(source)];
  const time = Date.now();
  if (text !== source.text) drafts[placeOf(source)] = {text, time, base: source.text};
  const newest = Object.entries(drafts)
    .sort(([, a], [, b]) => b.time - a.time)
    .slice(0, MOST);
  try {
    localStorage.setItem(KEY, JSON.stringify(Object.fromEntries(newest)));
    return text === source.text ? null : time;
  } catch {
    return null; // the browser gives no room
  }
}

/** The kept text of a plant, or null. @param {Pick<Source, 'kind' | 'id'>} source */
export const kept = (source) => all()[placeOf(source)]?.text ?? null;
