// pages/runs/notebook: filters in addresses and requests, the words of a line.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {addressOf as addressOfChoice, queryOf, readChoice} from '../../frontend/pages/runs/compare/choice.js';
import {addressOf, NO_FILTER, readFilter, requestOf} from '../../frontend/pages/runs/notebook/filter.js';
import {addressOfRun, nameOf} from '../../frontend/pages/runs/notebook/line-words.js';

/** @import * as service from '../../frontend/types/service.js' */

test('a filter survives the address', () => {
  assert.equal(addressOf(NO_FILTER), '/runs/');
  const filter = {...NO_FILTER, q: 'λ > 2, lab', tag: 'fig. 4', pinned: true, since: 'week', sort: 'rmse'};
  for (const one of [filter, {...filter, descending: false}, {...NO_FILTER, descending: false}, NO_FILTER])
    assert.deepEqual(readFilter(addressOf(one).replace('/runs/', '')), one);
});

test('spans of time begin at midnight', () => {
  const today = new Date(2026, 10, 30, 21, 5);
  /** @param {string} since */
  const begin = (since) =>
    new URL(requestOf({...NO_FILTER, since}, 100, 0, today), 'http://x').searchParams.get('since');
  assert.equal(begin('today'), String(new Date(2026, 10, 30).getTime() / 1000));
  assert.equal(begin('week'), String(new Date(2026, 10, 23).getTime() / 1000));
  assert.equal(begin('any'), null);
});

const line = /** @type {service.RunLine} */ (
  /** @type {unknown} */ ({id: '0123456789', name: '', record: null, experiment: 'zhao-2012', changes: []})
);
/** @param {string} path @param {number | string | null} to */
const change = (path, to) => ({path, label: {code: '', args: {}, text: ''}, from: 1, to});

test('a run has the name of its owner, of its record, or the beginning of its id', () => {
  assert.equal(nameOf(line), 'r-0123');
  assert.equal(nameOf({...line, record: 'rig-7.csv'}), 'rig-7.csv');
  assert.equal(nameOf({...line, record: 'rig-7.csv', name: 'Monday'}), 'Monday');
});

test('a run opens with its changes in the form if the form can show them all', () => {
  assert.equal(
    addressOfRun({...line, changes: [change('seed', 3)]}),
    '?experiment=zhao-2012&set=seed%3D3&run=0123456789',
  );
  for (const one of [change('plant', 'x*'), change('faults.y#2.size', 1), change('observers.a', null)])
    assert.equal(addressOfRun({...line, changes: [change('seed', 3), one]}), '?run=0123456789');
  assert.equal(addressOfRun({...line, experiment: null, changes: null}), '?run=0123456789');
});

test('a comparison is in its address: runs, observer, and whether curves are less the first', () => {
  for (const one of [
    {ids: ['a1', 'b2'], observer: '', less: false},
    {ids: ['a1', 'b2', 'c3'], observer: 'ekf & co', less: true},
  ])
    assert.deepEqual(readChoice(addressOfChoice(one).replace('/runs/', '')), one);
  assert.equal(addressOfChoice({ids: ['a1'], observer: 'x', less: true}), '/runs/');
  assert.equal(String(queryOf({ids: ['a1', 'b2'], observer: '', less: true})), 'ids=a1%2Cb2&less=true');
});
