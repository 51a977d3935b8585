// The state of the live page (types.d.ts) and its subscribers. How events change it is in reduce.js.

/** @import {Event} from '../types.js' */

/** @import {State, StateEvent, Store} from '../types.js' */

/** @type {State} */
export const initial = Object.freeze({
  connection: 'starting',
  session: null,
  role: 'control',
  experiment: null,
  spec: null,
  plant: null,
  columns: [],
  epoch: 0,
  step: 0,
  record: 0,
  row: 0,
  t: 0,
  playing: false,
  speed: 1,
  rate: null,
  viewers: 1,
  ended: false,
  log: [],
  alarms: [],
  diagnosis: null,
  checks: {},
  observers: [],
  faults: [],
  noise: {},
  broken: null,
  facts: null,
  past: null,
  twins: [],
  converging: [],
  places: {},
  parent: null,
  origin: null,
  window: 30,
  windows: [10, 30, 100],
  begunPlain: false,
  selection: null,
  cursor: null,
  looking: null,
  band: null,
  strips: {},
  planes: [],
  table: false,
  site: null,
  presentation: false,
  desk: 'inject',
  theme: 'light',
  language: 'en',
  problem: null,
  notice: null,
  noting: null,
  lesson: null,
});

/**
 * Equal, or alike one level down: a select may build an array or an object.
 * @param {unknown} a
 * @param {unknown} b
 */
export function alike(a, b) {
  if (Object.is(a, b)) return true;
  if (
    typeof a !== 'object' ||
    typeof b !== 'object' ||
    a === null ||
    b === null ||
    Array.isArray(a) !== Array.isArray(b)
  )
    return false;
  const [one, other] = /** @type {{[key: string]: unknown}[]} */ ([a, b]);
  const keys = Object.keys(one);
  return keys.length === Object.keys(other).length && keys.every((key) => Object.is(one[key], other[key]));
}

/**
 * @template T
 * @typedef {{select: (state: State) => T, fn: (value: T, before: T | undefined) => unknown, value: T}} Watcher
 */

/**
 * @param {State} begin
 * @param {(state: State, event: StateEvent) => State} reduce
 * @returns {Store}
 */
export function createStore(begin, reduce) {
  let state = begin;
  /** @type {Set<Watcher<unknown>>} */
  const watchers = new Set();
  return {
    get state() {
      return state;
    },

    /** Call `fn(value, before)` now and whenever `select(state)` has changed. Returns a function that ends it. */
    subscribe(select, fn) {
      const watcher = {select, fn, value: select(state)};
      watchers.add(/** @type {Watcher<unknown>} */ (/** @type {unknown} */ (watcher)));
      fn(watcher.value, undefined);
      return () => {
        watchers.delete(/** @type {Watcher<unknown>} */ (/** @type {unknown} */ (watcher)));
      };
    },

    /** @param {Event} event */
    dispatch(event) {
      const next = reduce(state, event);
      if (next === state) return;
      state = next;
      for (const watcher of watchers) {
        const value = watcher.select(state);
        if (alike(value, watcher.value)) continue;
        const before = watcher.value;
        watcher.value = value;
        try {
          watcher.fn(value, before);
        } catch (error) {
          console.error(error); // one panel that fails must not silence the others
        }
      }
    },
  };
}
