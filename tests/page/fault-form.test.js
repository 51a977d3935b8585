// live/panels/inject/fault-form.js: the form of a fault from the catalogue's description of its shape.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {
  firstValues,
  limits,
  mainField,
  mainScale,
  ownFields,
  read,
  asTyped,
} from '../../frontend/live/panels/inject/fault-form.js';

/** @import {Subject} from '../../frontend/live/panels/inject/fault-form.js' */
/** @import * as service from '../../frontend/types/service.js' */

/** @param {Partial<service.FormField>} more @returns {service.FormField} */
const field = (more) =>
  /** @type {service.FormField} */ ({
    name: 'size',
    type: 'number',
    required: true,
    nullable: false,
    description: '',
    ...more,
  });

/** @type {service.FaultForm} */
const shape = {
  shape: 'sine',
  on: 'channel',
  description: '',
  fields: [
    field({name: 'channel', type: 'string'}),
    field({name: 'onset'}),
    field({name: 'end'}),
    field({}),
    field({name: 'frequency'}),
    field({name: 'mode', type: 'choice', default: 'hold'}),
  ],
  example: {frequency: 3, mode: 'linear'},
};

/** @type {Subject} */
const subject = {
  name: 'f',
  onChannel: true,
  typical: 2,
  bounds: [-1, null],
  unit: 'N',
  level: 5,
  horizon: 100,
  sampleTime: 0.1,
};

test('the fields of a shape are its own, and the first number has the slider', () => {
  assert.deepEqual(
    ownFields(shape).map(({name}) => name),
    ['size', 'frequency', 'mode'],
  );
  assert.equal(mainField(shape)?.name, 'size');
  assert.equal(mainField({...shape, fields: []}), null);
});

test('first values follow the subject, else the default of the field, else the example', () => {
  assert.deepEqual(firstValues(shape, subject), {size: 2, frequency: 0.1, mode: 'hold'});
  assert.equal(firstValues({...shape, fields: [field({name: 'odd'})], example: {odd: 7}}, subject).odd, 7);
});

test('the slider of a size stays within the bounds of its channel and holds the first value', () => {
  const scale = mainScale(field({}), subject, 2);
  assert.deepEqual([scale.min, scale.max], [-1, 6]);
  assert.deepEqual(limits(field({}), subject), {low: -1, high: Infinity});
  const bounded = mainScale(field({name: 'probability', minimum: 0, maximum: 1}), subject, 0.3);
  assert.deepEqual([bounded.min, bounded.max, bounded.kind], [0, 1, 'linear']);
  assert.equal(mainScale(field({name: 'std', above: 0}), subject, 0.5).kind, 'log');
});

test('a typed text becomes a value of its field, or nothing', () => {
  assert.deepEqual(
    ['1,5', ' −2 ', 'x', '', '1e400'].map((text) => read(field({}), text)),
    [1.5, -2, undefined, undefined, undefined],
  );
  assert.equal(read(field({nullable: true}), ' '), null);
  assert.deepEqual(read(field({type: 'array'}), '1; 2, 3'), [1, 2, 3]);
  assert.equal(read(field({type: 'array'}), '1 b'), undefined);
  assert.deepEqual(
    [read(field({above: 0}), '0'), read(field({minimum: 0}), '0'), read(field({maximum: 1}), '2')],
    [undefined, 0, undefined],
  );
});

test('a value is spelt as one types it', () => {
  for (const value of [1.5, -2e-9, [0, 2], null]) {
    const type = Array.isArray(value) ? 'array' : 'number';
    assert.deepEqual(read(field({type, nullable: true}), asTyped(value)), value);
  }
});
