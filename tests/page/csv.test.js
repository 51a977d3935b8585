// pages/records/csv.js: the columns of a record for its picture, and only those that the server needs.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {columnsOf, needed} from '../../frontend/pages/records/csv.js';

const plant = {outputs: [{name: 'y'}], inputs: [{name: 'u'}], signals: []};

test('columns are read with commas, tabs, or semicolons and decimal commas', () => {
  for (const csv of ['t,y\n0,1.5\n1,2.5\n', 't\ty\r\n0\t1.5\r\n1\t2.5', 't; y\n0;1,5\n1;2,5'])
    assert.deepEqual(columnsOf(csv), {t: [0, 1], y: [1.5, 2.5]});
});

test('a record keeps time, outputs and inputs, under either spelling, and no other column', () => {
  assert.equal(needed('t,extra,y.y,u,more\n0,9,1,2,9\n1,9,3,4,9', plant), 't,y.y,u\n0,1,2\n1,3,4');
  assert.equal(needed('time;u;y\n0;1,5;2', plant), 'time;y;u\n0;2;1,5');
});

test('blank lines stay, so that the server names the lines of the file', () => {
  assert.equal(needed('t,y,z\n0,1,2\n\n1,3,4\n', plant), 't,y\n0,1\n\n1,3\n');
});

test('a record that lacks a column, names one twice, quotes, or has uneven rows is sent as it is', () => {
  for (const csv of ['t,z\n0,1', 't,y,y\n0,1,2', 't,y,z\n0,1\n', 't,y,"z"\n0,1,2', 't,u,y\n0,1,2\n7\n2,3,4'])
    assert.equal(needed(csv, plant), csv);
});

test('of two spellings of a column the one with its kind is meant', () => {
  assert.equal(needed('t,y,y.y,z\n0,1,2,3', plant), 't,y.y\n0,2');
});
