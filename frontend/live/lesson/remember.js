// What was answered in which session, kept in this tab: a page that is loaded again shows it again.

const ANSWERS = 'thetascope.lesson';

/**
 * What was answered in which session.
 * @typedef {object} Remembered
 * @property {string} session
 * @property {string} lesson
 * @property {number} place
 * @property {number | null} chosen
 * @property {number | null} dial
 * @property {number[] | null} [sketch]
 * @property {number} mark
 * @property {boolean} ran
 */

/** @param {Remembered | null} value */
export function remember(value) {
  try {
    sessionStorage.setItem(ANSWERS, JSON.stringify(value));
  } catch {
    /* private windows keep nothing */
  }
}

/** @returns {Remembered | null} */
export function remembered() {
  try {
    return JSON.parse(sessionStorage.getItem(ANSWERS) ?? 'null');
  } catch {
    return null;
  }
}
