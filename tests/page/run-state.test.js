// pages/runs/run-state.js: the state of the page of runs.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Problem} from '../../frontend/common/api.js';
import {createStore, initial, original, reduce, formField, stale} from '../../frontend/pages/runs/run-state.js';

/** @import {Experiment, Plant, Run, RunState} from '../../frontend/pages/types.js' */

const spec = /** @type {Experiment} */ (
  /** @type {unknown} */ ({
    seed: 1,
    noise: {y: {std: 0.1}},
    observers: [{label: 'adaptive', gains: {rho: 4}}],
    faults: [
      {channel: 'theta3', size: 0.02},
      {output: 'y', shape: 'stuck'},
    ],
  })
);
const plant = /** @type {Plant} */ ({});
const run = /** @type {Run} */ ({});

/** @param {Partial<RunState>} more @returns {RunState} */
const state = (more = {}) => ({...initial, chosen: 'a', spec, plant, ...more});

test('a path finds a value by field, index, label, channel or output', () => {
  assert.deepEqual(
    [
      'seed',
      'noise.y.std',
      'observers.adaptive.gains.rho',
      'observers.0.label',
      'faults.theta3.size',
      'faults.y.shape',
    ].map((path) => original(spec, path)),
    [1, 0.1, 4, 'adaptive', 0.02, 'stuck'],
  );
  for (const path of ['missing', 'noise.z.std', 'faults.9.size', 'seed.deeper', 'length'])
    assert.equal(original(spec, path), undefined, path);
});

test('a field of a refusal is formField as the form spells it', () => {
  assert.equal(formField(spec, 'observers[0].gains.rho'), 'observers.adaptive.gains.rho');
  assert.equal(formField(spec, 'noise.y.std'), 'noise.y.std');
  assert.equal(formField(spec, 'faults[1].end'), 'faults.1.end');
});

test('a change is kept until it is taken back to the value of the library', () => {
  const changed = reduce(state(), {type: 'change', path: 'seed', to: 7});
  assert.deepEqual(changed.changes, {seed: 7});
  assert.deepEqual(reduce(changed, {type: 'change', path: 'seed', to: 1}).changes, {});
  assert.deepEqual(reduce(changed, {type: 'change', path: 'seed', to: undefined}).changes, {});
});

test('figures are stale once the form differs from the run that they show', () => {
  const done = reduce(state({changes: {seed: 7}}), {type: 'done', run, changes: {seed: 7}});
  assert.deepEqual([done.phase, stale(done), stale(state())], ['done', false, false]);
  assert.equal(stale(reduce(done, {type: 'change', path: 'seed', to: 8})), true);
});

test('a change after a refusal clears it, and shows the last run again if there is one', () => {
  const problem = new Problem({title: 'refused'});
  const failed = reduce(state(), {type: 'failed', problem});
  assert.equal(reduce(failed, {type: 'change', path: 'seed', to: 2}).phase, 'idle');
  const again = reduce({...failed, run}, {type: 'changes', changes: {}});
  assert.deepEqual([again.phase, again.problem], ['done', null]);
});

test('another experiment starts without changes, run or problem of the one before', () => {
  const next = reduce(state({run, changes: {seed: 3}, phase: 'done'}), {type: 'choose', id: 'b'});
  assert.deepEqual([next.chosen, next.spec, next.run, next.changes, next.phase], ['b', null, null, {}, 'idle']);
});

test('views are called with the state and the one before, whenever it changes', () => {
  const store = createStore();
  /** @type {string[]} */
  const seen = [];
  store.subscribe((now, before) => seen.push(`${before.phase}>${now.phase}`));
  store.dispatch({type: 'start'});
  store.dispatch({type: 'cancelled'});
  assert.deepEqual(seen, ['idle>running', 'running>cancelled']);
});
