// Where somebody is in the course, kept in this browser: the step of each lesson, and which steps were done.

/** @typedef {{step: number, done: number[], of: number, at: number}} Place */

const KEY = 'thetascope.course';

/** @returns {{[lesson: string]: Place}} */
export function places() {
  try {
    return JSON.parse(localStorage.getItem(KEY) ?? '{}');
  } catch {
    return {};
  }
}

/**
 * Keep the place in a lesson.
 * @param {string} lesson
 * @param {Partial<Place>} change
 */
export function keepPlace(lesson, change) {
  const all = places();
  const before = all[lesson] ?? {step: 0, done: [], of: 1};
  const place = {...before, ...change, at: Date.now()};
  try {
    localStorage.setItem(KEY, JSON.stringify({...all, [lesson]: place}));
  } catch {
    /* private windows keep nothing */
  }
}

/**
 * Note that a step was done.
 * @param {string} lesson
 * @param {number} step
 */
export function markDone(lesson, step) {
  const done = places()[lesson]?.done ?? [];
  if (!done.includes(step)) keepPlace(lesson, {done: [...done, step]});
}

/** Whether all steps of a lesson were done. @param {Place | undefined} place */
export const finished = (place) => place !== undefined && place.done.length >= place.of;
