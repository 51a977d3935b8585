// live/panels/plant/diagram.js: the blocks of a plant's picture and the fault sites on them.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {blocks, layout, sandwich, WIDTH} from '../../frontend/live/panels/plant/diagram.js';

/** @import {Plant} from '../../frontend/live/types.js' */

/** @param {object} more @returns {Plant} */
const plant = (more = {}) =>
  /** @type {Plant} */ (
    /** @type {unknown} */ ({
      inputs: [{name: 'u'}],
      states: [{name: 'x1'}, {name: 'x2'}],
      outputs: [{name: 'y', description: ''}],
      definitions: [],
      dynamics: {x1: 'u', x2: 'x1'},
      channels: [
        {name: 'a', title: 'actuator', kind: 'actuator', enters: {x1: '1'}},
        {name: 'p', title: '', kind: 'process', enters: {x2: '1'}},
        {name: 's', title: '', kind: 'sensor', enters: {}},
      ],
      ...more,
    })
  );

const hysteretic = plant({
  states: [{name: 'x'}, {name: 'm'}, {name: 'z'}],
  definitions: [{name: 'v', expression: 'backlash(x, m, 1, 0.1, 0.1)'}],
  dynamics: {x: 'u - x', m: 'v', z: 'v - z'},
  channels: [
    {name: 'before', title: '', kind: 'process', enters: {x: '1'}},
    {name: 'behind', title: '', kind: 'process', enters: {z: '1'}},
  ],
});

test('faults are on the block that they act on, disturbances of the measurement at the sensor', () => {
  const sites = blocks(plant()).map(({id, sites: on}) => [id, on.map(({subject}) => subject)]);
  assert.deepEqual(sites, [
    ['actuator', ['a']],
    ['plant', ['p']],
    ['sensor', ['s', 'y']],
  ]);
});

test('a plant without inputs and actuator faults has no actuator', () => {
  assert.deepEqual(
    blocks(plant({inputs: [], channels: []})).map(({id}) => id),
    ['plant', 'sensor'],
  );
});

test('a sandwich has its states before, in and after the hysteresis', () => {
  assert.equal(sandwich(plant()), null);
  assert.deepEqual(sandwich(hysteretic), {before: ['x'], memory: ['m'], after: ['z']});
  const sites = new Map(blocks(hysteretic).map(({id, sites: on}) => [id, on.map(({subject}) => subject)]));
  assert.deepEqual([sites.get('l1'), sites.get('l2')], [['before'], ['behind']]);
});

test('blocks follow each other within the picture, and every site is on its block', () => {
  const many = Array.from({length: 9}, (_, k) => ({name: `f${k}`, title: '', kind: 'process', enters: {x1: '1'}}));
  for (const one of [plant(), hysteretic, plant({channels: many})]) {
    const {blocks: boxes, height, foot} = layout(one);
    boxes.forEach((box, k) => {
      assert.ok(box.x >= 0 && box.x + box.width <= WIDTH);
      assert.ok(k === 0 || box.x > boxes[k - 1].x + boxes[k - 1].width);
      assert.ok(box.y >= 0 && box.y + box.height < foot && foot < height);
      for (const {y} of box.spots) assert.ok(y >= 0 && y <= box.y + box.height + 1);
    });
  }
});

test('the controllers are between the plant and the observers, and their wires do not cross the blocks', () => {
  const open = layout(plant());
  assert.equal(open.loop, null);
  const {loop, axis, foot, height} = layout(
    plant({controllers: [{name: 'PI', period: 0.5, outputs: []}], references: [{name: 'r'}]}),
  );
  assert(loop && loop.y - loop.height / 2 > axis + 26 && foot - 23 > loop.y + loop.height / 2);
  assert(loop.mark + 12 < loop.x && loop.mark - 12 > 13 && height > open.height);
});
