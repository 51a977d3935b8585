// pages/records: changes of a mapping, remedies of a misfit, and the address that reopens a record.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {read, write} from '../../frontend/pages/records/address.js';
import {remedyFor} from '../../frontend/pages/records/fit/remedy.js';
import {timeUnitWith, unitWith} from '../../frontend/pages/records/fit/units.js';
import {assigned, isProposal, withProposal, withTime, withUnit} from '../../frontend/pages/records/mapping.js';

const none = {column: null, unit: null, factor: null, offset: null};
/** @param {string} column @param {string} unit */
const from = (column, unit) => ({...none, column, unit});
/** @type {import('../../frontend/pages/records/types.js').Mapping} */
const mapping = {
  time: {column: 't', unit: 's', period: null},
  quantities: {q: from('flow', 'cm³/s'), y1: from('a', 'cm'), y2: from('b', 'cm')},
};
/** @param {string} name @param {'input' | 'output'} role @param {string} unit @param {string[]} units */
const quantity = (name, role, unit, units) => ({
  ...{name, role, unit, units, column: mapping.quantities[name].column, column_unit: unit, factor: 1, offset: 0},
});
const quantities = [
  quantity('q', 'input', 'cm³/s', ['cm³/s', 'L/min']),
  quantity('y1', 'output', 'cm', ['cm', 'm', 'mm']),
  quantity('y2', 'output', 'cm', ['cm', 'm', 'mm']),
];
/**
 * @param {'time' | 'output' | 'offset' | 'fahrenheit' | 'input' | 'swap-outputs' | 'parameter'} kind
 * @param {string} name
 * @param {number | null} [factor]
 */
const remedy = (kind, name, factor = null) => remedyFor({kind, name, factor}, {mapping, quantities});

test('a column is read as one quantity only, and a quantity has one column', () => {
  const changed = assigned(mapping, 'a', 'y2', 1);
  assert.deepEqual(changed.quantities, {q: from('flow', 'cm³/s'), y1: none, y2: {...none, column: 'a'}});
  assert.deepEqual(assigned(mapping, 'b', '', 1).quantities.y2, none);
  assert.deepEqual(mapping.quantities.y2, from('b', 'cm'));
});

test('a column becomes the times, and times that lose their column keep the period', () => {
  assert.deepEqual(assigned(mapping, 'a', 'time', 0.5), {
    time: {column: 'a', unit: null, period: null},
    quantities: {...mapping.quantities, y1: none},
  });
  assert.deepEqual(assigned(mapping, 't', '', 0.5).time, {column: null, unit: null, period: 0.5});
});

test('units, times and proposals change only their part', () => {
  assert.deepEqual(withUnit(mapping, 'y1', 'm').quantities, {...mapping.quantities, y1: from('a', 'm')});
  assert.deepEqual(withTime(mapping, {unit: 'min'}), {...mapping, time: {column: 't', unit: 'min', period: null}});
  const proposed = withProposal(mapping, {time: {unit: 'h'}, quantities: {y2: {unit: 'mm'}}});
  assert.deepEqual(proposed.time, {column: 't', unit: 'h', period: null});
  assert.deepEqual(proposed.quantities, {...mapping.quantities, y2: from('b', 'mm')});
  assert.deepEqual([isProposal({time: {}}), isProposal(null), isProposal('x')], [true, false, false]);
});

test('a factor is named as a unit where the quantity has one, else it multiplies', () => {
  assert.equal(unitWith('cm', 100, ['cm', 'm', 'mm']), 'm');
  assert.equal(unitWith('cm³/s', 1000 / 60, ['cm³/s', 'L/min']), 'L/min');
  assert.equal(unitWith('cm', 100, ['cm', 'mm']), null);
  assert.equal(timeUnitWith('s', 60), 'min');
  assert.equal(timeUnitWith('epoch-s', 1e-3), 'epoch-ms');
  const metres = remedy('output', 'y1', 100);
  assert.deepEqual([metres?.code, metres?.args], ['page.records.remedy.unit', {name: 'y1', unit: 'm'}]);
  assert.deepEqual(metres?.mapping?.quantities.y1, from('a', 'm'));
  const odd = remedy('output', 'y1', 7);
  assert.deepEqual(odd?.mapping?.quantities.y1, {...none, column: 'a', factor: 7, offset: 0});
});

test('each suspect has its remedy; all outputs are changed together', () => {
  const all = remedy('output', '*', 0.1);
  assert.deepEqual(all?.args, {name: 'y1, y2', unit: 'mm'});
  assert.deepEqual(all?.mapping?.quantities, {q: mapping.quantities.q, y1: from('a', 'mm'), y2: from('b', 'mm')});
  assert.deepEqual(remedy('time', '', 60)?.mapping?.time, {column: 't', unit: 'min', period: null});
  assert.equal(remedy('time', '', 7), null);
  const swapped = remedy('swap-outputs', 'y1, y2')?.mapping?.quantities;
  assert.deepEqual([swapped?.y1, swapped?.y2], [from('b', 'cm'), from('a', 'cm')]);
  assert.deepEqual(remedy('parameter', 'UA')?.parameters, ['UA']);
  assert.deepEqual(remedy('offset', 'y1', 273.15)?.mapping?.quantities.y1, {
    ...none,
    column: 'a',
    factor: 1,
    offset: 273.15,
  });
  assert.equal(remedy('fahrenheit', 'y1'), null);
});

test('a period takes the factor where there is no column of times', () => {
  const without = {...mapping, time: {column: null, unit: null, period: 0.5}};
  const longer = remedyFor({kind: 'time', name: '', factor: 60}, {mapping: without, quantities});
  assert.deepEqual(longer?.mapping?.time, {column: null, unit: null, period: 30});
});

test('the address holds record, plant, mapping, settings and step', async () => {
  const plain = {record: 'abc', plant: 'dts200', mapping: null, settings: null, step: 1};
  assert.equal(await write(plain), '?record=abc&plant=dts200');
  const settings = {healthy: {begin: 0, end: 9}, false_alarms: 0.1, fit: /** @type {const} */ ('auto'), parameters: []};
  for (const link of [plain, {...plain, mapping, settings, step: 3}]) {
    const [search, hash = ''] = (await write(link)).split('#');
    assert.deepEqual(await read({search, hash: `#${hash}`}), link);
  }
  assert.deepEqual(await read({search: '?record=abc&step=9', hash: '#r=%%'}), {...plain, plant: null});
});
