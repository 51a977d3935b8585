// What is kept in this browser: the half-made answer of the present mystery, and how many were played.

/** @import * as service from '../../../types/service.js' */

/** @typedef {{key: string, t: number}} Claim   a channel, or channels joined by commas, named at a time */

/**
 * @typedef {object} Place
 * @property {string} seed         with the set-up, if that was chosen
 * @property {number} now          time in s up to which the record was watched
 * @property {string} choice       a channel, 'none', 'alike', or '' before a choice
 * @property {string[]} alike      channels that look alike
 * @property {number | null} size
 * @property {number | null} onset
 * @property {Claim[]} claims      in order of time
 * @property {service.ChallengeAnswer | null} answer   once it was given
 */

const PLACE = 'thetascope.mystery';
const PLAYED = 'thetascope.mysteries';

/** @param {string} seed @returns {Place} */
export const fresh = (seed) => ({
  seed,
  now: 0,
  choice: '',
  alike: [],
  size: null,
  onset: null,
  claims: [],
  answer: null,
});

/** The place that was kept, if it is of this seed. @param {string} seed @returns {Place} */
export function keptPlace(seed) {
  try {
    const kept = JSON.parse(sessionStorage.getItem(PLACE) ?? 'null');
    return kept?.seed === seed ? {...fresh(seed), ...kept} : fresh(seed);
  } catch {
    return fresh(seed);
  }
}

/** @param {Place} place */
export function keepPlace(place) {
  try {
    sessionStorage.setItem(PLACE, JSON.stringify(place));
  } catch {
    /* private windows keep nothing */
  }
}

/** How many mysteries were solved here, and the most points. @returns {{seeds: string[], best: number}} */
export function played() {
  try {
    const kept = JSON.parse(localStorage.getItem(PLAYED) ?? '{}');
    return {seeds: Array.isArray(kept.seeds) ? kept.seeds : [], best: Number(kept.best) || 0};
  } catch {
    return {seeds: [], best: 0};
  }
}

/** Count a mystery, by its first answer only. @param {string} seed @param {number} points */
export function markPlayed(seed, points) {
  const {seeds, best} = played();
  if (seeds.includes(seed)) return;
  try {
    localStorage.setItem(PLAYED, JSON.stringify({seeds: [...seeds, seed], best: Math.max(best, points)}));
  } catch {
    /* private windows keep nothing */
  }
}

/** The place of a mystery among those that were played. @param {string} seed */
export function roundOf(seed) {
  const {seeds} = played();
  const at = seeds.indexOf(seed);
  return at < 0 ? seeds.length + 1 : at + 1;
}

/** A seed that nobody has chosen. */
export function anySeed() {
  const bytes = crypto.getRandomValues(new Uint8Array(5));
  return Array.from(bytes, (byte) => (byte % 36).toString(36)).join('');
}
