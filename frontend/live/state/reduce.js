// How events change the state of the live page. Pure: (state, event) → state. Events are the server's messages, as they come, and the page's own.

import {alarmsOf, plantBroke} from '../../diagnosis/alarms.js';

const COLOURS = 6; // --o0 … --o5
const MOST_EVENTS = 5000;

const EARLY = 1e-3; // of a row: times that differ by rounding only are the same

/** What counts at present is what acts from the next row on: what was done while time stands still is shown at once. */
const nextRow = ({t, record}) => t + record * (1 + EARLY);

/**
 * Observers that watch at time t, from the spec's own and its timed commands, with the colours they had. `places`: those of observers that have
 * gone, too, so that one that is started again comes back in its own.
 */
export function observersAt(spec, t, before = [], log = [], places = {}) {
  const watching = new Map(
    spec.observers.map((config) => [config.label, {config, gains: {...config.gains}, since: 0}]),
  );
  for (const command of spec.commands ?? []) {
    if (command.at > t) break;
    if (command.command === 'add-observer') {
      watching.set(command.observer.label, {
        config: command.observer,
        gains: {...command.observer.gains},
        since: command.at,
      });
    } else if (command.command === 'remove-observer') watching.delete(command.label);
    else if (command.command === 'set-gain' && watching.has(command.observer))
      watching.get(command.observer).gains[command.gain] = command.value;
  }
  const taken = new Map(before.filter(({label}) => watching.has(label)).map(({label, place}) => [label, place]));
  return [...watching].map(([label, {config, gains, since}]) => {
    if (!taken.has(label)) taken.set(label, free(new Set(taken.values()), places[label]));
    const place = taken.get(label);
    const fallen = log.findLast((event) => event.kind === 'diverged' && event.subject === label && event.t >= since);
    return {
      label,
      kind: config.kind,
      colour: `var(--o${place % COLOURS})`,
      place,
      gains,
      options: config.options ?? {},
      config,
      since,
      diverged: fallen ? {t: fallen.t, text: fallen.text} : null,
    };
  });
}

function free(taken, own) {
  if (own !== undefined && !taken.has(own)) return own;
  let place = 0;
  while (taken.has(place)) place += 1;
  return place;
}

/** The spec's faults and whether they act at time t. */
export function faultsAt(spec, t) {
  return spec.faults.map((fault) => ({
    subject: fault.channel ?? fault.output,
    onChannel: 'channel' in fault,
    shape: fault.shape,
    fault,
    onset: fault.onset,
    end: fault.end ?? null,
    active: fault.onset <= t && (fault.end === null || fault.end === undefined || fault.end > t),
    ended: (fault.end ?? Infinity) <= t,
  }));
}

/** The measurement noise of every output at time t: {output: {std, sample_time}}. */
export function noiseAt(spec, t) {
  const noise = {...spec.noise};
  for (const {command, at, output, std, sample_time: held} of spec.commands ?? [])
    if (command === 'set-noise' && at <= t) noise[output] = {std, sample_time: held};
  return noise;
}

/** Keep the old array where nothing in it has changed, so that nobody is told for nothing. */
const steady = (before, now) => (JSON.stringify(before) === JSON.stringify(now) ? before : now);

/** What follows from spec, time and log. */
function derived(state) {
  if (!state.spec) return state;
  const t = nextRow(state);
  const observers = steady(state.observers, observersAt(state.spec, t, state.observers, state.log, state.places));
  return {
    ...state,
    observers,
    places: steady(state.places, {
      ...state.places,
      ...Object.fromEntries(observers.map(({label, place}) => [label, place])),
    }),
    noise: steady(state.noise, noiseAt(state.spec, t)),
    broken: state.log.find(plantBroke)?.t ?? null,
    faults: steady(state.faults, faultsAt(state.spec, t)),
    alarms: steady(state.alarms, alarmsOf(state.log, state.diagnosis)),
  };
}

/** Whether a fault began or ended, or a command of the spec took effect, between two times. */
function turned(spec, before, now) {
  const between = (t) => t !== null && t !== undefined && t > Math.min(before, now) && t <= Math.max(before, now);
  return (
    spec !== null &&
    (spec.faults.some((fault) => between(fault.onset) || between(fault.end)) ||
      (spec.commands ?? []).some((command) => between(command.at)))
  );
}

/** Windows of about a tenth, a third and all of the horizon: 10, 30 and 100 s for a horizon of 100 s. A fork keeps the one that was chosen. */
function windowsFor(spec, state) {
  const power = 10 ** Math.floor(Math.log10(spec.horizon) + 1e-9);
  const most = spec.horizon / power >= 2.5 ? 3 * power : power;
  const windows = [most / 10, most === power ? 0.3 * power : power, most].map((length) =>
    Number(length.toPrecision(3)),
  );
  return {windows, window: state.parent && windows.includes(state.window) ? state.window : windows[1]};
}

const messages = {
  hello: (state, hello) =>
    derived({
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
    }),
  status: (state, status) => {
    const {type: _, ...rest} = status;
    const next = {...state, ...rest};
    return turned(state.spec, nextRow(state), nextRow(next)) ? derived(next) : next;
  },
  event: (state, event) => derived({...state, log: [...state.log, event].slice(-MOST_EVENTS)}),
  columns: (state, {epoch, columns}) => ({...state, epoch, columns}),
  rewound: (state, {epoch, row, t}) =>
    derived({
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
  spec: (state, {spec}) => derived({...state, spec, plant: steady(state.plant, spec.plant)}),
  diagnosis: (state, {diagnosis}) => derived({...state, diagnosis: steady(state.diagnosis, diagnosis)}),
  assumptions: (state, {observer, checks}) => ({
    ...state,
    checks: {...state.checks, [observer]: steady(state.checks[observer], checks)},
  }),
};

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
    faults: [],
    alarms: [],
    log: [],
    checks: {},
    diagnosis: null,
    strips: {},
    selection: null,
    looking: null,
    cursor: null,
    band: null,
    site: null,
    problem: null,
    ended: false,
    row: 0,
    t: 0,
  }),
  failed: (state, {problem}) => ({...state, connection: 'failed', problem}),
  set: (state, {type: _, ...values}) => ({...state, ...values}),
  strip: (state, {name, shown}) => ({...state, strips: {...state.strips, [name]: shown}}),
};

/** @type {(state: import('./store.js').State, event: object) => import('./store.js').State} */
export function reduce(state, event) {
  const change = messages[event.type] ?? own[event.type];
  if (!change) return state; // a newer server may say more
  return change(state, event);
}
