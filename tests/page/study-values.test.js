// Values of what varies in a study, as one writes them.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {factorOf, textOf} from '../../frontend/pages/studies/values.js';

test('a range with its number of values, in a grid and sampled', () => {
  const range = {kind: 'range', name: '', path: 'p', low: 0.5, high: 16, scale: 'log', points: 8};
  for (const text of ['0.5 … 16, 8, log', '0.5..16,8,log', ' 0.5 ... 16 , 8 , log '])
    assert.deepEqual(factorOf('p', text, true), range);
  assert.deepEqual(factorOf('p', '0.5 … 16, log', false), {...range, points: null});
  assert.deepEqual(factorOf('p', '-1e-3 … 2', true), {...range, low: -0.001, high: 2, scale: 'linear', points: 5});
});

test('a list of numbers, words and truth values; nothing for an empty text', () => {
  assert.deepEqual(factorOf('p', '0.1, 2  3e-4', true), {kind: 'list', name: '', path: 'p', values: [0.1, 2, 3e-4]});
  assert.deepEqual(factorOf('p', 'step true', true), {kind: 'list', name: '', path: 'p', values: ['step', true]});
  assert.equal(factorOf('p', '  ', true), null);
});

test('a factor is written as it is read', () => {
  for (const text of ['0.5 … 16, 8, log', '-1 … 2, 3', '0.1 0.2 word']) {
    const factor = factorOf('p', text, true);
    assert.ok(factor);
    assert.equal(textOf(factor), text);
  }
});
