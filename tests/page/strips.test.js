// live/state/strips.js: which strips a session has, and what each draws.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {derivedColumns, stripsOf} from '../../frontend/live/state/strips.js';
import {initial} from '../../frontend/live/state/store.js';

/** @import {FaultState, ObserverState, Plant, State} from '../../frontend/live/types.js' */

const names = ['a', 'b', 'c', 'd', 'e', 'f', 'g', 'h'];

/** @param {number} channels @param {number} states @param {number} outputs */
const plant = (channels, states = 2, outputs = 1) =>
  /** @type {Plant} */ (
    /** @type {unknown} */ ({
      channels: names.slice(0, channels).map((name) => ({name, title: `fault ${name}`, unit: 'N', typical: 2})),
      states: names.slice(0, states).map((name) => ({name, unit: '', description: `state ${name}; more`})),
      outputs: names.slice(0, outputs).map((name) => ({name, unit: 'm', description: ''})),
    })
  );

/** @param {string} label @param {number} place */
const observer = (label, place) =>
  /** @type {ObserverState} */ (
    /** @type {unknown} */ ({label, place, dashed: false, colour: `var(--o${place})`, gains: {}, diverged: null})
  );

/** @param {Partial<State>} more @returns {State} */
const state = (more) => ({...initial, ...more});

const COLUMNS = ['t', 'x.a', 'x.b', 'y.a', 'theta.a', 'o.theta.a', 'o.sigma.a', 'o.x.a', 'o.x.b', 'o.y.a', 'o.pe'];

test('bands, residuals and the excitation are computed from the columns that arrive', () => {
  const derived = new Map(derivedColumns(COLUMNS).map((one) => [one.name, one]));
  assert.deepEqual([...derived.keys()].sort(), ['o.excitation', 'o.high.a', 'o.low.a', 'o.residual.a']);
  assert.equal(derived.get('o.low.a')?.make(5, 1), 3);
  assert.equal(derived.get('o.high.a')?.make(5, 1), 7);
  assert.equal(derived.get('o.residual.a')?.make(5, 4), 1);
  assert.deepEqual(
    [1, 1e-3, 0, -1, NaN].map((value) => derived.get('o.excitation')?.make(value, NaN)),
    [0, -3, -12, -12, NaN],
  );
});

test('an estimate is drawn with its band where the observer says how sure it is', () => {
  const all = stripsOf(state({plant: plant(1), columns: COLUMNS, observers: [observer('o', 0), observer('p', 1)]}));
  const theta = all.find(({name}) => name === 'theta.a');
  assert.deepEqual(theta?.traces, [
    {
      label: 'o',
      colour: 'var(--o0)',
      place: 0,
      dashed: false,
      fallen: null,
      column: 'o.theta.a',
      low: 'o.low.a',
      high: 'o.high.a',
    },
  ]);
  assert.deepEqual(
    all.map(({name}) => name),
    ['theta.a', 'x.a', 'x.b', 'residual.a', 'excitation'],
  );
});

test('of many channels six are shown, those with a fault first, and always a channel that has one', () => {
  const columns = names.map((name) => `o.theta.${name}`);
  /** @param {string[]} subjects */
  const shown = (subjects) => {
    const faults = subjects.map((subject) => /** @type {FaultState} */ (/** @type {unknown} */ ({subject})));
    const all = stripsOf(state({plant: plant(8), columns, observers: [observer('o', 0)], faults}));
    return all.filter((strip) => strip.kind === 'theta' && strip.shown).map(({subject}) => subject);
  };
  assert.deepEqual(shown([]), names.slice(0, 6));
  assert.deepEqual(shown(['h']), ['a', 'b', 'c', 'd', 'e', 'h']);
  assert.deepEqual(shown(names), names);
});

test('what was chosen by hand is shown or hidden, whatever is usual', () => {
  const one = {plant: plant(1), columns: COLUMNS, observers: [observer('o', 0)]};
  const hidden = stripsOf(state({...one, strips: {'theta.a': false}}));
  assert.equal(hidden.find(({name}) => name === 'theta.a')?.shown, false);
  assert.equal(stripsOf(state({plant: null})).length, 0);
});

test('a projector shows the channels and one state, or states and a residual without estimates of faults', () => {
  const one = {plant: plant(1), columns: COLUMNS, observers: [observer('o', 0)], presentation: true};
  /** @param {Partial<State>} more */
  const shown = (more) => stripsOf(state({...one, ...more})).filter((strip) => strip.shown);
  assert.deepEqual(
    shown({}).map(({name}) => name),
    ['theta.a', 'x.a'],
  );
  assert.deepEqual(
    shown({columns: COLUMNS.filter((name) => !/theta|sigma|pe/.test(name))}).map(({name}) => name),
    ['x.a', 'x.b', 'residual.a'],
  );
});

test('the axis of a channel holds its typical size, on the side to which the fault goes', () => {
  for (const [typical, base] of /** @type {[number, number[]][]} */ ([
    [2, [-1.4, 3]],
    [-2, [-3, 1.4]],
  ])) {
    const known = plant(1);
    known.channels[0].typical = typical;
    const [strip] = stripsOf(state({plant: known, columns: COLUMNS, observers: [observer('o', 0)]}));
    assert.deepEqual([strip.base, strip.least], [base, 2]);
  }
});

test('a loop has a strip for each set point, with the reading of its unit, and for each input that is set', () => {
  const closed = /** @type {Plant} */ (
    /** @type {unknown} */ ({
      ...plant(1),
      outputs: [
        {name: 'level', unit: 'cm', description: ''},
        {name: 'flow', unit: 'l/s', description: ''},
      ],
      inputs: [
        {name: 'q', unit: 'l/s', description: 'pump'},
        {name: 'free', unit: '', description: ''},
      ],
      references: [{name: 'r', unit: 'cm', description: 'level'}],
      controllers: [{outputs: [{input: 'q', saturation: [null, null]}]}],
    })
  );
  const loop = stripsOf(state({plant: closed, columns: COLUMNS})).filter(({kind}) => kind === 'loop');
  assert.deepEqual(
    loop.map(({name, truth, reading}) => [name, truth, reading?.column]),
    [
      ['r.r', 'r.r', 'y.level'],
      ['u.q', 'u.q', undefined],
    ],
  );
});

test('inputs and known signals have strips that are shown when they are chosen', () => {
  const whole = /** @type {Plant} */ (
    /** @type {unknown} */ ({
      ...plant(1),
      inputs: [
        {name: 'u', unit: 'V', description: 'voltage'},
        {name: 'q', unit: 'm', description: ''},
      ],
      signals: [{name: 'phi', unit: '', description: ''}],
      references: [],
      controllers: [{outputs: [{input: 'q'}]}],
    })
  );
  const columns = [...COLUMNS, 'u.u', 'u.q', 'signal.phi'];
  const of = (/** @type {Partial<State>} */ more) =>
    stripsOf(state({plant: whole, columns, observers: [observer('o', 0)], ...more})).filter(
      ({kind}) => kind === 'input',
    );
  assert.deepEqual(
    of({}).map(({name, shown}) => [name, shown]),
    [
      ['u.u', false],
      ['signal.phi', false],
    ],
  );
  assert.deepEqual(of({presentation: true, strips: {'u.u': true}})[0].shown, true);
  assert.equal(of({})[0].reading?.column, 'u.u');
});

test('a residual that is blind to a channel has a strip with its threshold, in place of an estimate', () => {
  const columns = ['t', 'y.a', 'o.y.a', 'o.residual.c', 'o.residual.b'];
  const all = stripsOf(state({plant: plant(3), columns, observers: [observer('o', 0), observer('p', 1)]}));
  const found = all.filter(({kind}) => kind === 'relation');
  assert.deepEqual(
    found.map(({name, threshold, shown}) => [name, threshold, shown]),
    [
      ['relation.b', 1, true],
      ['relation.c', 1, true],
    ],
  );
  assert.deepEqual(
    found[0].traces.map(({column}) => column),
    ['o.residual.b'],
  );
  assert.equal(stripsOf(state({plant: plant(3), columns: COLUMNS})).filter(({kind}) => kind === 'relation').length, 0);
});
