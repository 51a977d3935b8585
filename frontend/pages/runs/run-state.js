// The state of the page and how events change it. One way: event → reduce → views.

/** @import {Experiment, Phase, RunEvent, RunState, RunView} from '../types.js' */

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

const cleared = {phase: 'idle', problem: null, run: null, ranWith: null};

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
export const reduce = (state, event) => events[event.type](state, event);

/**
 * Whether the form asks for something else than what the figures show.
 * @param {RunState} state
 */
export const stale = (state) => state.run !== null && state.ranWith !== JSON.stringify(state.changes);

/**
 * The value at a path of the specification; items of lists by index, label, name, channel or output.
 * @param {Experiment} spec
 * @param {string} path
 * @returns {unknown}
 */
export function original(spec, path) {
  return path.split('.').reduce((at, key) => {
    if (at === undefined || at === null) return undefined;
    if (!Array.isArray(at)) return at[key];
    return at[key] ?? at.find((item) => [item.label, item.name, item.channel, item.output].includes(key));
  }, spec);
}

/**
 * A field's name in an answer of the server, spelt as the form spells it: observers[0].gains.rho → observers.adaptive.gains.rho.
 * @param {Experiment} spec
 * @param {string} field
 */
export function spelt(spec, field) {
  const keys = field.replaceAll('[', '.').replaceAll(']', '').split('.').filter(Boolean);
  let at = spec;
  return keys
    .map((key) => {
      const inside = Array.isArray(at);
      const item = inside ? (at[key] ?? at.find((one) => one.label === key)) : at?.[key];
      at = item;
      return inside && item?.label ? item.label : key;
    })
    .join('.');
}

/** The store: `dispatch(event)`, `state`, and `subscribe(view)`, which is called with (state, before). */
export function createStore() {
  let state = initial;
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
