// live/state/gain-entries.js: the numbers of a gain, in a column or a matrix too.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {entriesOf, placeName, withEntry} from '../../frontend/live/state/gain-entries.js';

test('every entry of a number, a column and a matrix has its place', () => {
  assert.deepEqual(entriesOf(4), [{place: [], value: 4}]);
  assert.deepEqual(entriesOf([1, 2]), [
    {place: [0], value: 1},
    {place: [1], value: 2},
  ]);
  assert.deepEqual(
    entriesOf([
      [1, 2],
      [3, 4],
    ]).map(({place}) => place.join()),
    ['0,0', '0,1', '1,0', '1,1'],
  );
  assert.deepEqual(entriesOf(null), [{place: [], value: null}]);
});

test('another number at a place leaves the others and the given gain alone', () => {
  const matrix = [
    [1, 2],
    [3, 4],
  ];
  assert.deepEqual(withEntry(matrix, [1, 0], 9), [
    [1, 2],
    [9, 4],
  ]);
  assert.deepEqual(matrix[1], [3, 4]);
  assert.equal(withEntry(4, [], 5), 5);
});

test('a place has the labels of its row and column, or their numbers', () => {
  assert.equal(placeName([1], {rows: ['x1', 'x2'], columns: []}), 'x2');
  assert.equal(placeName([0, 1], {rows: ['x1', 'x2'], columns: ['y', 'z']}), 'x1, z');
  assert.equal(placeName([0, 1]), '1, 2');
  assert.equal(placeName([]), '');
});
