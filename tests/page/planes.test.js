// live/state/planes.js: the quantities of a session, and the curves of a phase plane.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {curvesOf, nextPlane, quantitiesOf} from '../../frontend/live/state/planes.js';

/** @import {State} from '../../frontend/live/types.js' */

const named = (/** @type {string[]} */ ...names) => names.map((name) => ({name}));
const state = /** @type {State} */ (
  /** @type {unknown} */ ({
    plant: {
      states: named('p', 'v'),
      channels: named('f'),
      outputs: named('y'),
      inputs: named('u'),
      signals: named('w'),
      references: [],
    },
    observers: [{label: 'a'}, {label: 'b'}],
    columns: ['x.p', 'x.v', 'theta.f', 'y.y', 'u.u', 'a.x.p', 'a.x.v', 'a.y.y', 'b.x.p', 'a.theta.f'],
    lesson: null,
  })
);
const all = quantitiesOf(state);
/** @param {string} id */
const quantity = (id) => {
  const found = all.find((one) => one.id === id);
  assert.ok(found, id);
  return found;
};

test('a session has states, faults, readings with their estimates and residuals, and inputs', () => {
  assert.deepEqual(
    all.map(({id}) => id),
    ['state.p', 'state.v', 'theta.f', 'output.y', 'estimated.y', 'residual.y', 'input.u'],
  );
  assert.deepEqual(quantitiesOf({...state, plant: null}), []);
});

test('a plane of two states has the true curve and those of observers that estimate both', () => {
  assert.deepEqual(curvesOf(quantity('state.p'), quantity('state.v'), state), [
    {label: 'a', x: 'a.x.p', y: 'a.x.v'},
    {label: null, x: 'x.p', y: 'x.v'},
  ]);
});

test('what nobody estimates is common to all observers', () => {
  assert.deepEqual(curvesOf(quantity('input.u'), quantity('residual.y'), state), [
    {label: 'a', x: 'u.u', y: 'a.residual.y'},
  ]);
  assert.deepEqual(curvesOf(quantity('input.u'), quantity('output.y'), state), [{label: null, x: 'u.u', y: 'y.y'}]);
});

test('a lesson that hides the truth has no true curves', () => {
  const secret = {
    ...state,
    lesson: {id: 'l', place: 0, truth: false, diagnosis: true, line: null, sketch: null, sites: [], until: null},
  };
  const [p, v] = quantitiesOf(secret);
  assert.deepEqual(
    curvesOf(p, v, secret).map(({label}) => label),
    ['a'],
  );
});

test('planes are added until there are three, each another pair', () => {
  const first = nextPlane([], all);
  assert.deepEqual(first, {x: 'state.p', y: 'state.v'});
  assert.deepEqual(nextPlane(first ? [first] : [], all), {x: 'estimated.y', y: 'residual.y'});
  const one = {x: 'state.p', y: 'state.v'};
  assert.equal(nextPlane([one, one, one], all), null);
});
