// widgets/ordering.js: the order of a table's rows, and the best values of a column.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {ascending, best} from '../../frontend/widgets/ordering.js';

test('the smallest value is the best, with those that differ by less than a hundredth', () => {
  assert.deepEqual([...best([3, 1, 1.009, 1.02])], [1, 2]);
  assert.deepEqual([...best([NaN, 2, null, 5])], [1]);
  assert.deepEqual([...best([0, 0, 4])], [0, 1]);
});

test('nothing is the best without a larger value', () => {
  assert.deepEqual([...best([])], []);
  assert.deepEqual([...best([2])], []);
  assert.deepEqual([...best([2, 2.001, null])], []);
});

test('rows are sorted by their values; those without one come last, equal ones keep their order', () => {
  assert.deepEqual(ascending([3, 1, 2]), [1, 2, 0]);
  assert.deepEqual(ascending([null, 2, NaN, 2, 1]), [4, 1, 3, 0, 2]);
});
