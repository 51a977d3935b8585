// The state of the live page and who is told of its changes. How events change it is in reduce.js.

/**
 * @typedef {object} ObserverState
 * @property {string} label
 * @property {string} kind          as in the catalogue
 * @property {string} colour        'var(--o0)' …: kept as long as it watches
 * @property {number} place         number of the colour
 * @property {object} gains         present values of those that were set (the catalogue has the defaults)
 * @property {object} options
 * @property {object} config        ObserverConfig with which it began to watch
 * @property {number} since         time in s from which it watches
 * @property {{t: number, text: string} | null} diverged
 *
 * @typedef {object} FaultState     one fault of the spec, on a channel or on a measurement
 * @property {string} subject       channel or output
 * @property {boolean} onChannel
 * @property {string} shape
 * @property {object} fault         as the spec has it, times of the session
 * @property {number} onset
 * @property {number | null} end
 * @property {boolean} active       from the next row on: what was injected while time stands still counts already
 *
 * @typedef {object} State
 * @property {'starting'|'live'|'reconnecting'|'ended'|'full'|'failed'} connection
 * @property {string | null} session      id
 * @property {'control'|'view'} role      a viewer may look, not touch
 * @property {string | null} experiment   id of the library experiment it began with (null: a spec of one's own)
 * @property {object | null} spec         Experiment with everything done so far, plant in full
 * @property {object | null} plant        spec.plant
 * @property {string[]} columns
 * @property {number} epoch
 * @property {number} step                of the integration, s
 * @property {number} record              s between rows
 * @property {number} row                 rows so far (from status: a few times a second)
 * @property {number} t                   time now (the same)
 * @property {boolean} playing
 * @property {number | null} speed        null: as fast as possible
 * @property {number | null} rate         measured
 * @property {number} viewers
 * @property {boolean} ended              at the horizon, or the plant escaped
 * @property {object[]} log               Events, oldest first
 * @property {import('../../diagnosis/alarms.js').Alarm[]} alarms   of the detector, oldest first, of the past that stands
 * @property {object | null} diagnosis    ObserverDiagnosis: how the detector sees the session (a little ahead of what is shown)
 * @property {Object<string, object[]>} checks    observer label → assumption checks
 * @property {ObserverState[]} observers
 * @property {FaultState[]} faults        oldest first
 * @property {Object<string, {std: number, sample_time: number}>} noise   of every output now: what the spec began with, and what was set since
 * @property {number | null} broken       when the plant itself broke down
 * @property {Object<string, number>} places    observer label → number of its colour, of those that have gone, too
 * @property {{id: string, t: number} | null} parent    the session that this one was forked from
 * @property {{observers: ObserverState[], faults: FaultState[], alarms: object[]} | null} origin   what is known of that one
 * @property {number | null} window       length of the scope's window in s; null: all
 * @property {number[]} windows           those to choose from
 * @property {boolean} begunPlain         began with a library experiment as it is
 * @property {[number, number] | null} selection    zoomed to
 * @property {number | null} cursor       time under the pointer
 * @property {number | null} looking      time that is looked back to on the timeline
 * @property {string | null} band         observer whose band alone is drawn; null: all of them
 * @property {Object<string, boolean>} strips   strip name → shown, where chosen by hand
 * @property {string | null} site         fault site that was chosen in the plant
 * @property {boolean} presentation
 * @property {string} desk                the tab that is open while presenting
 * @property {'light'|'dark'} theme
 * @property {'en'|'zh'} language
 * @property {{title: string, detail: string} | null} problem    why there is no session
 * @property {{text: string, kind: 'note'|'problem', action: {words: string, act: () => void, alone?: boolean} | null, at: number} | null} told   alone: offered while nobody else watches
 */

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
  site: null,
  presentation: false,
  desk: 'inject',
  theme: 'light',
  language: 'en',
  problem: null,
  told: null,
});

/** Equal, or alike one level down: a select may build an array or an object. */
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
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => Object.is(a[key], b[key]));
}

/**
 * @param {State} begin
 * @param {(state: State, event: object) => State} reduce
 */
export function createStore(begin, reduce) {
  let state = begin;
  const watchers = new Set();
  return {
    get state() {
      return state;
    },

    /** Tell `fn(value, before)` now and whenever `select(state)` has changed. Returns a function that ends it. */
    subscribe(select, fn) {
      const watcher = {select, fn, value: select(state)};
      watchers.add(watcher);
      fn(watcher.value, undefined);
      return () => watchers.delete(watcher);
    },

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
