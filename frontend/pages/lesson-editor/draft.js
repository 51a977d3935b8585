// The lesson that is being made: kept in this browser until it is saved, and changed in place.

/** @import * as service from '../../types/service.js' */

/** @typedef {NonNullable<service.CourseStepInput['measures']>[string]} Measure */
/** @typedef {service.ConditionInput} Condition */
/** @typedef {Omit<service.AnswerInput, 'text'> & {text: service.Words}} DraftAnswer */
/** @typedef {Omit<service.SawInput, 'text'> & {text: service.Words}} DraftSaw */

/**
 * What the page writes in a step: its words may be empty, in one language or in both.
 * @typedef {object} Written
 * @property {service.Words} title
 * @property {service.Words[]} say
 * @property {service.Words | null} [short]
 * @property {service.StepViewInput & {strips: string[]}} show
 * @property {service.Words | null} [ask]
 * @property {DraftAnswer[]} [answers]
 * @property {DraftSaw[]} [saw]
 * @property {service.Words | null} [look]
 * @property {service.Words[]} [why]
 * @property {service.Words | null} [cause]
 */

/** @typedef {Omit<service.CourseStepInput, keyof Written> & Written} DraftStep */

/**
 * A lesson while it is made. Lists and words may still be empty, which the service refuses.
 * @typedef {Omit<service.CourseLessonInput, 'title' | 'outcome' | 'steps'>
 *   & {title: service.Words, outcome: service.Words, steps: DraftStep[]}} DraftLesson
 */

const KEY = 'thetascope.lesson-draft';

/** @returns {DraftLesson | null} */
export function keptDraft() {
  try {
    return JSON.parse(localStorage.getItem(KEY) ?? 'null');
  } catch {
    return null;
  }
}

/** @param {DraftLesson} draft */
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

/** A lesson with one step and no experiment yet. @param {string} title @returns {DraftLesson} */
export const emptyLesson = (title) => ({
  id: '',
  minutes: 10,
  title: {en: title, zh: ''},
  outcome: {en: '', zh: ''},
  experiments: {},
  steps: [],
});

/**
 * A step of a stretch of a recording.
 * @param {string} experiment
 * @param {number} from
 * @param {number} until
 * @returns {DraftStep}
 */
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
 * The languages in which something is written; null: none.
 * @param {service.Words | null | undefined} words
 * @returns {service.WordsInput | null}
 */
function written(words) {
  const kept = Object.fromEntries(Object.entries(words ?? {}).filter(([, text]) => String(text).trim()));
  return Object.keys(kept).length ? kept : null;
}

/** @param {service.Words[] | undefined} paragraphs */
const allWritten = (paragraphs) => (paragraphs ?? []).flatMap((one) => written(one) ?? []);

/**
 * A step as it can be saved.
 * @param {DraftStep} step
 * @param {service.WordsInput} untitled
 * @returns {service.CourseStepInput}
 */
function finishedStep(step, untitled) {
  const say = allWritten(step.say);
  /** @type {service.CourseStepInput} */
  const clean = {
    ...step,
    title: written(step.title) ?? untitled,
    say: say.length ? say : [{en: '…'}],
    ask: written(step.ask),
    short: written(step.short),
    look: written(step.look),
    cause: written(step.cause),
    why: allWritten(step.why),
    answers: (step.answers ?? []).map((one) => ({...one, text: written(one.text) ?? {en: '…'}})),
    saw: (step.saw ?? []).filter((one) => written(one.text)),
  };
  const keys = /** @type {(keyof service.CourseStepInput)[]} */ (Object.keys(clean));
  for (const key of keys) if (clean[key] === null || clean[key] === undefined) put(clean, key, undefined);
  return clean;
}

/**
 * The lesson as it can be saved: without empty words, and with a step's title where none was written.
 * @param {DraftLesson} draft
 * @param {string} untitled
 * @returns {service.CourseLessonInput}
 */
export function finished(draft, untitled) {
  const title = written(draft.title) ?? {en: untitled};
  return {
    ...draft,
    id: draft.id || slug(draft.title.en || ''),
    number: 0,
    title,
    outcome: written(draft.outcome) ?? title,
    steps: draft.steps.map((step) => finishedStep(step, {en: untitled})),
  };
}

/**
 * Set a field, or leave it out where nothing was chosen.
 * @template {object} T
 * @template {keyof T} K
 * @param {T} target
 * @param {K} key
 * @param {T[K] | undefined} value
 */
export function put(target, key, value) {
  if (value === undefined) delete target[key];
  else target[key] = value;
}
