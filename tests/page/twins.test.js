// live/scope/twins.js and widgets/line-style.js: which observers' curves are dash-dotted.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {coloured} from '../../frontend/live/state/reduce.js';
import {coincident} from '../../frontend/live/scope/twins.js';

/** @import * as service from '../../frontend/types/service.js' */
/** @import {Samples, Strip} from '../../frontend/live/types.js' */

const labels = ['a', 'b', 'c'];

/**
 * Two strips of 100 px for values of 0 … 1, each observer at a constant value.
 * @param {{[label: string]: number}[]} values   by strip
 * @param {string[]} [before]
 */
function twins(values, before = []) {
  const rows = values.map((one, strip) => ({
    strip: /** @type {Strip} */ (
      /** @type {unknown} */ ({
        traces: Object.keys(one).map((label) => ({label, column: `${label}.${strip}`})),
      })
    ),
    range: {low: 0, high: 1},
    height: 100,
  }));
  const samples = /** @type {Samples} */ (
    /** @type {unknown} */ ({
      record: 1,
      rows: 50,
      value: (/** @type {string} */ column) => values[Number(column.split('.')[1])][column.split('.')[0]],
    })
  );
  return coincident(rows, labels, samples, [0, 50], before);
}

test('the later of two observers is a twin where they coincide in all strips that both are in', () => {
  assert.deepEqual(twins([{a: 0.2, b: 0.205, c: 0.6}]), ['b']);
  assert.deepEqual(twins([{a: 0.2, b: 0.2, c: 0.2}]), ['b', 'c']);
  assert.deepEqual(
    twins([
      {a: 0.2, b: 0.2},
      {a: 0.1, b: 0.4},
    ]),
    [],
  );
  assert.deepEqual(
    twins([
      {a: 0.2, c: 0.2},
      {a: 0.1, b: 0.4},
    ]),
    ['c'],
  );
  assert.deepEqual(twins([{a: 0.2}, {b: 0.2}]), [], 'no strip has both');
  assert.deepEqual(twins([{a: NaN, b: NaN}]), [], 'there is nothing to compare');
});

test('twins stay twins until their curves are clearly apart', () => {
  assert.deepEqual(twins([{a: 0.2, b: 0.215}]), []);
  assert.deepEqual(twins([{a: 0.2, b: 0.215}], ['b']), ['b']);
  assert.deepEqual(twins([{a: 0.2, b: 0.225}], ['b']), []);
});

test('twelve observers have twelve different looks', () => {
  const running = /** @type {service.ObserverNow[]} */ (
    /** @type {unknown} */ (Array.from({length: 12}, (_, i) => ({label: `o${i}`})))
  );
  const looks = coloured(running).map(({colour, dashed}) => `${colour} ${dashed}`);
  assert.equal(new Set(looks).size, 12);
  assert.deepEqual([looks[6], looks[7]], ['var(--o6) false', 'var(--o0) true']);
  assert.equal(coloured(running, [], {}, ['o1'])[1].dashed, true);
});
