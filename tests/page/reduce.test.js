// live/state/reduce.js and store.js: how messages and the page's own events change its state, and which subscribers
// are called.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {reduce} from '../../frontend/live/state/reduce.js';
import {alike, createStore, initial} from '../../frontend/live/state/store.js';

/** @import * as service from '../../frontend/types/service.js' */
/** @import {Event, Experiment, ServerMessage, State, StateEvent} from '../../frontend/live/types.js' */

/** @type {service.Facts} */
const facts = {
  t: 0,
  observers: [],
  faults: [],
  noise: {},
  truth: {deviation: 0, parameters: {}, process_noise: {}, outputs: {}, states: [], dynamics: {}, record: null},
  broken: null,
  judged: null,
  alarms: [],
  alarm_verdicts: [],
  fault_outcomes: [],
  undetected: [],
  summary: {code: 'diagnosis.summary.quiet', args: {}, text: ''},
};

/** @param {number} horizon */
const spec = (horizon = 100) => /** @type {Experiment} */ (/** @type {unknown} */ ({horizon, plant: {id: 'p'}}));

/** @param {Partial<Extract<ServerMessage, {type: 'hello'}>>} more @returns {StateEvent} */
const hello = (more = {}) => ({
  type: 'hello',
  protocol: 1,
  session: 's',
  role: 'control',
  spec: spec(),
  columns: ['t'],
  epoch: 1,
  step: 0.001,
  record: 0.01,
  row: 501,
  playing: false,
  speed: 1,
  parent: null,
  log: [],
  facts,
  ...more,
});

/** @param {number} row @param {Event['kind']} kind */
const event = (row, kind) => /** @type {Event} */ (/** @type {unknown} */ ({type: 'event', row, t: row / 100, kind}));

/** @param {...StateEvent} events @returns {State} */
const after = (...events) => events.reduce(reduce, initial);

const begin = /** @type {StateEvent} */ ({type: 'begin', session: 's', role: 'control', experiment: 'e'});

test('a hello makes the state live, at the time of its last row', () => {
  const state = after(begin, hello());
  assert.deepEqual([state.connection, state.session, state.t, state.row, state.plant?.id], ['live', 's', 5, 501, 'p']);
});

test('the windows are about a tenth, a third and all of the horizon', () => {
  for (const [horizon, windows] of /** @type {[number, number[]][]} */ ([
    [100, [10, 30, 100]],
    [40, [3, 10, 30]],
    [5, [0.3, 1, 3]],
    [2, [0.1, 0.3, 1]],
    [3600, [300, 1000, 3000]],
  ])) {
    const state = after(begin, hello({spec: spec(horizon)}));
    assert.deepEqual(state.windows, windows, `${horizon} s`);
    assert.equal(state.window, windows[1]);
  }
});

test('a fork keeps the window that was chosen, another session does not', () => {
  const chosen = after(begin, hello(), {type: 'set', window: 10});
  const forked = /** @type {StateEvent} */ ({...begin, parent: {id: 's', t: 3}});
  const fork = [forked, hello({session: 'f', parent: 's'})].reduce(reduce, chosen);
  assert.deepEqual([fork.window, fork.parent], [10, {id: 's', t: 3}]);
  assert.equal([begin, hello()].reduce(reduce, chosen).window, 30);
});

test('a connection that comes back keeps the diagnosis and checks of its session', () => {
  const check = /** @type {service.AssumptionCheck} */ ({});
  const before = after(begin, hello(), {type: 'assumptions', observer: 'o', checks: [check]});
  assert.deepEqual(reduce(before, hello({epoch: 2})).checks, {o: [check]});
  assert.deepEqual(reduce(before, hello({session: 'other'})).checks, {});
});

test('going back drops the events after that row, and the zoom', () => {
  const log = [event(100, 'inject'), event(200, 'clear'), event(300, 'gain')];
  const before = after(begin, hello({log}), {type: 'set', selection: [1, 2], looking: 2});
  const back = reduce(before, {type: 'rewound', epoch: 2, row: 200, t: 2});
  assert.deepEqual(
    [back.log.map(({row}) => row), back.row, back.t, back.epoch, back.selection, back.looking, back.ended],
    [[100, 200], 200, 2, 2, null, null, false],
  );
});

test('a reset leaves nothing in the log but itself', () => {
  const before = after(begin, hello({log: [event(0, 'inject'), event(0, 'reset')]}));
  assert.deepEqual(
    reduce(before, {type: 'rewound', epoch: 2, row: 0, t: 0}).log.map(({kind}) => kind),
    ['reset'],
  );
});

test('time does not run on a page that has lost its session', () => {
  const running = after(begin, hello({playing: true}));
  assert.equal(reduce(running, {type: 'connection', now: 'reconnecting'}).playing, true);
  assert.equal(reduce(running, {type: 'connection', now: 'ended'}).playing, false);
});

test('a message of a newer server changes nothing', () => {
  const state = after(begin, hello());
  assert.equal(reduce(state, /** @type {StateEvent} */ (/** @type {unknown} */ ({type: 'news'}))), state);
});

test('equal facts leave arrays as they are, so that no subscriber is called', () => {
  const state = after(begin, hello());
  const again = reduce(state, {type: 'facts', row: 502, facts: structuredClone(facts)});
  for (const name of /** @type {const} */ (['observers', 'faults', 'alarms', 'noise', 'places']))
    assert.equal(again[name], state[name], name);
});

test('a subscriber is called at first and for changes of its selection only, one level deep', () => {
  const store = createStore(initial, reduce);
  /** @type {unknown[]} */
  const seen = [];
  const end = store.subscribe(
    (state) => [state.window, state.theme],
    (value, before) => seen.push([value[0], before?.[0]]),
  );
  store.dispatch({type: 'set', cursor: 5});
  store.dispatch({type: 'set', window: 10});
  end();
  store.dispatch({type: 'set', window: 20});
  assert.deepEqual(seen, [
    [30, undefined],
    [10, 30],
  ]);
});

test('values are alike when they are the same, or have the same entries', () => {
  const shared = {};
  for (const [a, b, same] of /** @type {[unknown, unknown, boolean][]} */ ([
    [NaN, NaN, true],
    [1, '1', false],
    [[1, shared], [1, shared], true],
    [[1, {}], [1, {}], false],
    [{a: 1}, {a: 1, b: 2}, false],
    [[1], {0: 1}, false],
    [null, {}, false],
  ]))
    assert.equal(alike(a, b), same, JSON.stringify([a, b]));
});
