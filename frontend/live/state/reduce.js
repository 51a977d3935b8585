// How events change the state of the live page. Pure: (state, event) → state. Events are the messages of the server
// and the page's own.

import {stateOf} from '../../diagnosis/findings.js';
import {colourOf, repeats} from '../../widgets/line-style.js';

/** @import {Ack, Experiment, Jump, ObserverState, OwnEvent, ServerMessage, State, StateEvent} from '../types.js' */
/** @import * as service from '../../types/service.js' */

/** @typedef {service.Refused} Refused */

/**
 * A function for each type of event.
 * @template {{type: string}} E
 * @typedef {{[K in E['type']]: (state: State, event: Extract<E, {type: K}>) => State}} Changes
 */

const MOST_EVENTS = 5000;

/**
 * The observers that run, with the colours they had. `places`: those of observers that were removed, too, so that one
 * that is started again gets its own back.
 * @param {service.ObserverNow[]} running
 * @param {ObserverState[]} before
 * @param {State['places']} places
 * @param {readonly string[]} twins   labels whose curves coincide with others
 * @returns {ObserverState[]}
 */
export function coloured(running, before = [], places = {}, twins = []) {
  const labels = new Set(running.map(({label}) => label));
  const taken = new Map(before.filter(({label}) => labels.has(label)).map(({label, place}) => [label, place]));
  return running.map((observer) => {
    const place = taken.get(observer.label) ?? free(new Set(taken.values()), places[observer.label]);
    taken.set(observer.label, place);
    return {...observer, colour: colourOf(place), place, dashed: repeats(place) || twins.includes(observer.label)};
  });
}

/**
 * The first free number, an observer's own one if it is free.
 * @param {Set<number>} taken
 * @param {number | undefined} own
 */
function free(taken, own) {
  if (own !== undefined && !taken.has(own)) return own;
  let place = 0;
  while (taken.has(place)) place += 1;
  return place;
}

/**
 * The old value if the new one is equal, so that subscribers are called for changes only.
 * @template T
 * @param {T | undefined} before
 * @param {T} now
 * @returns {T}
 */
const steady = (before, now) => (before !== undefined && JSON.stringify(before) === JSON.stringify(now) ? before : now);

/**
 * The state with newer facts of the server.
 * @param {State} state
 * @param {service.Facts} newer
 * @returns {State}
 */
function withFacts(state, newer) {
  const {facts, faults, alarms, noise, broken} = stateOf(newer);
  const observers = steady(state.observers, coloured(newer.observers, state.observers, state.places, state.twins));
  return {
    ...state,
    facts,
    observers,
    places: steady(state.places, {
      ...state.places,
      ...Object.fromEntries(observers.map(({label, place}) => [label, place])),
    }),
    noise: steady(state.noise, noise),
    broken,
    faults: steady(state.faults, faults),
    alarms: steady(state.alarms, alarms),
  };
}

/**
 * Windows of about a tenth, a third and all of the horizon: 10, 30 and 100 s for a horizon of 100 s. A fork keeps the
 * chosen one.
 * @param {Pick<Experiment, 'horizon'>} spec
 * @param {State} state
 */
function windowsFor(spec, state) {
  const power = 10 ** Math.floor(Math.log10(spec.horizon) + 1e-9);
  const most = spec.horizon / power >= 2.5 ? 3 * power : power;
  const windows = [most / 10, most === power ? 0.3 * power : power, most].map((length) =>
    Number(length.toPrecision(3)),
  );
  return {windows, window: state.parent && windows.includes(Number(state.window)) ? state.window : windows[1]};
}

/** @type {Changes<Exclude<ServerMessage, Ack | Jump | Refused>>} */
const messages = {
  hello: (state, hello) =>
    withFacts(
      {
        ...state,
        connection: hello.role === 'view' || hello.role === 'control' ? 'live' : state.connection,
        role: hello.role,
        session: hello.session,
        spec: hello.spec,
        plant: hello.spec.plant,
        columns: hello.columns,
        epoch: hello.epoch,
        step: hello.step,
        record: hello.record,
        row: hello.row,
        t: Math.max(0, hello.row - 1) * hello.record,
        playing: hello.playing,
        speed: hello.speed,
        log: hello.log.slice(-MOST_EVENTS),
        parent: hello.parent ? {id: hello.parent, t: state.parent?.id === hello.parent ? state.parent.t : null} : null,
        checks: state.session === hello.session ? state.checks : {},
        diagnosis: state.session === hello.session ? state.diagnosis : null,
        problem: null,
        ...(state.spec === null ? windowsFor(hello.spec, state) : {}),
      },
      hello.facts,
    ),
  status: (state, status) => {
    const {type: _, ...rest} = status;
    return {...state, ...rest};
  },
  event: (state, event) => ({...state, log: [...state.log, event].slice(-MOST_EVENTS)}),
  columns: (state, {epoch, columns}) => ({...state, epoch, columns}),
  rewound: (state, {epoch, row, t}) => ({
    ...state,
    epoch,
    row,
    t,
    ended: false,
    selection: null,
    looking: null,
    log: state.log.filter((event) => event.row <= row && !(row === 0 && event.kind !== 'reset')),
    diagnosis: state.diagnosis && {...state.diagnosis, alarms: []},
  }),
  spec: (state, {spec}) => ({...state, spec, plant: steady(state.plant, spec.plant)}),
  diagnosis: (state, {diagnosis}) => ({...state, diagnosis: steady(state.diagnosis, diagnosis)}),
  facts: (state, {facts}) => withFacts(state, facts),
  assumptions: (state, {observer, checks}) => ({
    ...state,
    checks: {...state.checks, [observer]: steady(state.checks[observer], checks)},
  }),
};

/** @type {Changes<OwnEvent>} */
const own = {
  connection: (state, {now}) => ({
    ...state,
    connection: now,
    playing: state.playing && (now === 'live' || now === 'reconnecting'),
  }),
  begin: (state, {session, role, experiment, parent}) => ({
    ...state,
    connection: 'starting',
    session,
    role,
    experiment,
    parent: parent ?? null,
    origin: null,
    spec: null,
    plant: null,
    columns: [],
    observers: [],
    places: {},
    noise: {},
    broken: null,
    facts: null,
    past: null,
    twins: [],
    converging: [],
    faults: [],
    alarms: [],
    log: [],
    checks: {},
    diagnosis: null,
    strips: {},
    planes: parent ? state.planes : [],
    table: parent ? state.table : false, // a fork is compared with its parent
    selection: null,
    looking: null,
    cursor: null,
    band: null,
    site: null,
    problem: null,
    noting: null,
    ended: false,
    row: 0,
    t: 0,
  }),
  failed: (state, {problem}) => ({...state, connection: 'failed', problem}),
  set: (state, {type: _, ...values}) => ({...state, ...values}),
  twins: (state, {labels}) => ({
    ...state,
    twins: labels,
    observers: coloured(state.observers, state.observers, state.places, labels),
  }),
  strip: (state, {name, shown}) => ({...state, strips: {...state.strips, [name]: shown}}),
};

/**
 * The state after an event.
 * @param {State} state
 * @param {StateEvent} event
 * @returns {State}
 */
export function reduce(state, event) {
  const changes = /** @type {{[type: string]: (state: State, event: StateEvent) => State}} */ ({...messages, ...own});
  return changes[event.type]?.(state, event) ?? state; // a newer server may send more
}
