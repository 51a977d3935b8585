// The lesson that is being made: kept in this browser until it is saved, and changed in place.

/** @import * as service from '../../types/service.js' */

/**
 * A lesson while it is made: everything may still be missing.
 * @typedef {{[name: string]: any}} Draft
 */

const KEY = 'thetascope.lesson-draft';

/** @returns {Draft | null} */
export function keptDraft() {
  try {
    return JSON.parse(localStorage.getItem(KEY) ?? 'null');
  } catch {
    return null;
  }
}

/** @param {Draft} draft */
export function keepDraft(draft) {
  try {
    localStorage.setItem(KEY, JSON.stringify(draft));
  } catch {
    /* private windows keep nothing */
  }
}

/** @param {string} title */
export const slug = (title) =>
  title
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, '-')
    .replace(/^-+|-+$/g, '')
    .slice(0, 48) || `lesson-${Date.now().toString(36)}`;

/** A lesson with one step and no experiment yet. @param {string} title @returns {Draft} */
export const emptyLesson = (title) => ({
  id: '',
  minutes: 10,
  title: {en: title, zh: ''},
  outcome: {en: '', zh: ''},
  experiments: {},
  steps: [],
});

/** A step of a stretch of a recording. @param {string} experiment @param {number} from @param {number} until */
export const newStep = (experiment, from, until) => ({
  title: {en: '', zh: ''},
  say: [{en: '', zh: ''}],
  start: {experiment, t: from},
  show: {strips: [], picture: 'plant', truth: true, diagnosis: false},
  ask: {en: '', zh: ''},
  answers: [],
  run: {seconds: until - from},
  measures: {},
  saw: [],
  look: {en: '', zh: ''},
  why: [],
});

/**
 * The lesson as it can be saved: without empty words, and with a step's title where none was written.
 * @param {Draft} draft
 * @param {string} untitled
 * @returns {service.CourseLesson}
 */
export function finished(draft, untitled) {
  const words = (/** @type {any} */ one, /** @type {string} */ instead = '') => {
    const kept = Object.fromEntries(Object.entries(one ?? {}).filter(([, text]) => String(text).trim()));
    return Object.keys(kept).length ? kept : instead ? {en: instead} : null;
  };
  const steps = draft.steps.map((/** @type {Draft} */ step) => {
    const say = (step.say ?? []).map((/** @type {any} */ one) => words(one)).filter(Boolean);
    const clean = {
      ...step,
      title: words(step.title, untitled),
      say: say.length ? say : [{en: '…'}],
      ask: words(step.ask),
      short: words(step.short),
      look: words(step.look),
      cause: words(step.cause),
      why: (step.why ?? []).map((/** @type {any} */ one) => words(one)).filter(Boolean),
      answers: (step.answers ?? []).map((/** @type {any} */ one) => ({...one, text: words(one.text, '…')})),
      saw: (step.saw ?? []).filter((/** @type {any} */ one) => words(one.text)),
    };
    return Object.fromEntries(Object.entries(clean).filter(([, value]) => value !== null && value !== undefined));
  });
  const title = words(draft.title, untitled) ?? {en: untitled};
  return /** @type {service.CourseLesson} */ (
    /** @type {unknown} */ ({
      ...draft,
      id: draft.id || slug(draft.title.en || ''),
      number: 0,
      title,
      outcome: words(draft.outcome) ?? title,
      steps,
    })
  );
}
