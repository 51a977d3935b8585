// The state of the page and how events change it. One way: event → reduce → views.

/** @import {Experiment, Phase, RunEvent, RunState, RunStore, RunView} from '../types.js' */

/** @type {RunState} */
export const initial = {
  experiments: null, // the library's list; null while it loads
  plants: {},
  chosen: null, // id
  spec: null, // of the chosen experiment, as the library has it
  plant: null, // in full
  foreign: false, // a run that is not of the library: it can be looked at, not changed
  changes: {}, // path → value, on top of it
  phase: 'idle', // idle, running, done, cancelled, failed
  progress: {status: 'queued', progress: 0, links: {}},
  run: null, // the last run that ended well
  ranWith: null, // its changes, as text, to tell whether the form has moved on
  problem: null, // {title, detail, errors}
};

/** @type {Pick<RunState, 'phase' | 'problem' | 'run' | 'ranWith'>} */
const cleared = {phase: 'idle', problem: null, run: null, ranWith: null};

/** @type {{[K in RunEvent['type']]: (state: RunState, event: Extract<RunEvent, {type: K}>) => RunState}} */
const events = {
  library: (state, {experiments, plants}) => ({...state, experiments, plants}),
  choose: (state, {id, changes}) => ({
    ...state,
    ...cleared,
    chosen: id,
    spec: null,
    plant: null,
    foreign: false,
    changes: changes ?? {},
  }),
  spec: (state, {spec, plant}) => ({...state, spec, plant}),
  foreign: (state, {spec, plant}) => ({...state, ...cleared, chosen: null, spec, plant, foreign: true, changes: {}}),
  change: (state, {path, to}) => {
    const changes = {...state.changes, [path]: to};
    if (to === undefined || to === original(state.spec, path)) delete changes[path];
    return {...state, changes, problem: null, phase: state.phase === 'failed' ? settled(state) : state.phase};
  },
  changes: (state, {changes}) => ({
    ...state,
    changes,
    problem: null,
    phase: state.phase === 'failed' ? settled(state) : state.phase,
  }),
  start: (state) => ({...state, phase: 'running', problem: null, progress: initial.progress}),
  progress: (state, {progress}) => ({...state, progress}),
  done: (state, {run, changes}) => ({...state, phase: 'done', run, ranWith: JSON.stringify(changes), problem: null}),
  cancelled: (state) => ({...state, phase: 'cancelled'}),
  failed: (state, {problem}) => ({...state, phase: 'failed', problem}),
};

/** @param {RunState} state @returns {Phase} */
const settled = (state) => (state.run ? 'done' : 'idle');

/**
 * @param {RunState} state
 * @param {RunEvent} event
 * @returns {RunState}
 */
export function reduce(state, event) {
  const change = /** @type {(state: RunState, event: RunEvent) => RunState} */ (events[event.type]);
  return change(state, event);
}

/**
 * Whether the form differs from the run that the figures show.
 * @param {RunState} state
 */
export const stale = (state) => state.run !== null && state.ranWith !== JSON.stringify(state.changes);

/**
 * One step into a value: a field by name, an item of a list by index, label, name, channel or output.
 * @param {unknown} at
 * @param {string} key
 * @returns {unknown}
 */
function step(at, key) {
  if (typeof at !== 'object' || at === null) return undefined;
  if (!Array.isArray(at)) return new Map(Object.entries(at)).get(key);
  return at[Number(key)] ?? at.find((item) => [item.label, item.name, item.channel, item.output].includes(key));
}

/**
 * The value at a path of the specification.
 * @param {Experiment | null} spec
 * @param {string} path
 * @returns {unknown}
 */
export const original = (spec, path) =>
  path.split('.').reduce((at, key) => step(at, key), /** @type {unknown} */ (spec));

/**
 * A field's name in an answer of the server, formField as the form spells it: observers[0].gains.rho →
 * observers.adaptive.gains.rho.
 * @param {Experiment | null} spec
 * @param {string} field
 */
export function formField(spec, field) {
  const keys = field.replaceAll('[', '.').replaceAll(']', '').split('.').filter(Boolean);
  /** @type {unknown} */
  let at = spec;
  return keys
    .map((key) => {
      const item = step(at, key);
      const label = Array.isArray(at) ? step(item, 'label') : undefined;
      at = item;
      return typeof label === 'string' && label ? label : key;
    })
    .join('.');
}

/** The store; views are called with (state, before) whenever the state has changed. @returns {RunStore} */
export function createStore() {
  let state = initial;
  /** @type {RunView[]} */
  const views = [];
  return {
    get state() {
      return state;
    },
    /** @param {RunView} view */
    subscribe(view) {
      views.push(view);
    },
    /** @param {RunEvent} event */
    dispatch(event) {
      const before = state;
      state = reduce(state, event);
      if (state !== before) for (const view of views) view(state, before);
    },
  };
}
