// live/panels/comparison/table-columns.js: the columns of the full comparison, and the file.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {columnsOf, csvOf} from '../../frontend/live/panels/comparison/table-columns.js';

/** @import * as service from '../../frontend/types/service.js' */

/** @param {string} name @param {Partial<service.EstimateInWindow>} [more] @returns {service.EstimateInWindow} */
const estimate = (name, more = {}) => ({name, rmse: 0.5, noise: null, settled: null, outcome: 'unknown', ...more});

const table = {
  t: 30,
  observers: [
    {label: 'a', estimates: [estimate('x.p'), estimate('theta.f', {noise: 0.1})]},
    {
      label: '=b,"c"',
      estimates: [
        estimate('x.p'),
        estimate('x.q', {rmse: null}),
        estimate('theta.f', {settled: 0.7, outcome: 'settled'}),
        estimate('theta.g'),
      ],
    },
  ],
};

test('errors come first, states before faults, then the faults with a step, then noise', () => {
  assert.deepEqual(
    columnsOf(table).map(({key}) => key),
    ['rmse:x.p', 'rmse:x.q', 'rmse:theta.f', 'rmse:theta.g', 'settle:theta.f', 'noise:theta.f', 'noise:theta.g'],
  );
  assert.deepEqual(columnsOf({t: 0, observers: []}), []);
});

test('the file has a line for each estimate, and no formulas', () => {
  const lines = csvOf(table).split('\r\n');
  assert.equal(lines.length, 1 + 6 + 1);
  assert.equal(lines[1], 'a,x.p,0.5,,,unknown');
  assert.equal(lines[4], `"'=b,""c""",x.q,,,,unknown`);
  assert.equal(lines[5], `"'=b,""c""",theta.f,0.5,,0.7,settled`);
});

test('no label begins a formula or a line, whatever stands before it', () => {
  for (const label of [' =1', '\n=1', '＝1', '\u0000+1', '\u0085@x', '\t-1']) {
    const [, line] = csvOf({t: 0, observers: [{label, estimates: [estimate('x.p')]}]}).split('\r\n');
    assert.match(line, /^"'[ ]?[=＝+@-]/u);
    assert.ok(line.endsWith(',x.p,0.5,,,unknown'));
  }
});
