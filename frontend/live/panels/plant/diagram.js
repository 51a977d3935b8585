// The blocks of a plant's picture and the fault sites on them, from its description. Nothing is drawn here.

import {NAME} from '../../../common/names.js';

/** @import {Channel} from '../../types.js' */
/** @import {Plant} from '../../../pages/types.js' */

/**
 * @typedef {{name: string, title: string, subject: string, onChannel: boolean}} Site
 * @typedef {Site & {x: number, y: number}} Spot
 * @typedef {Block & {x: number, y: number, width: number, height: number, top: number, columns: number,
 *   spots: Spot[]}} Box
 * @typedef {{x: number, y: number, width: number, height: number, mark: number}} Loop
 * @typedef {{blocks: Box[], axis: number, foot: number, height: number, left: number, right: number,
 *   loop: Loop | null}} Layout   `loop`: the controllers; `mark`: the place of their saturation
 * @typedef {{id: 'actuator'|'plant'|'l1'|'hysteresis'|'l2'|'sensor', states: string[], sites: Site[]}} Block
 */

/** @param {string} text */
const mentioned = (text) => new Set(String(text).match(NAME) ?? []);

/**
 * The states before, in and after a hysteresis of backlash operators; null where the plant has none.
 * @param {Plant} plant
 * @returns {{before: string[], memory: string[], after: string[]} | null}
 */
export function sandwich(plant) {
  const operators = plant.definitions.filter((one) => /\bbacklash\s*\(/.test(one.expression));
  if (operators.length === 0) return null;
  const states = plant.states.map((one) => one.name);
  const uses = Object.fromEntries(states.map((state) => [state, mentioned(plant.dynamics[state])]));
  const within = new Set(operators.flatMap((one) => [...mentioned(one.expression)]));
  const memory = states.filter((state) => within.has(state) && uses[state].size === 1 && !uses[state].has(state));
  // what comes after the hysteresis: its operators, then everything that uses them
  const carries = new Set(operators.map((one) => one.name));
  for (const one of plant.definitions)
    if ([...mentioned(one.expression)].some((name) => carries.has(name))) carries.add(one.name);
  /** @type {string[]} */
  const after = [];
  for (let grows = true; grows;) {
    grows = false;
    for (const state of states) {
      if (memory.includes(state) || after.includes(state) || ![...uses[state]].some((name) => carries.has(name)))
        continue;
      after.push(state);
      carries.add(state);
      grows = true;
    }
  }
  return {
    before: states.filter((state) => !memory.includes(state) && !after.includes(state)),
    memory,
    after: states.filter((state) => after.includes(state)),
  };
}

/**
 *
 * @param {Plant} plant
 * @returns {Block[]} from the input to the output
 */
export function blocks(plant) {
  /** @param {Channel} channel @returns {Site} */
  const site = (channel) => ({
    name: channel.name,
    title: channel.title || channel.name,
    subject: channel.name,
    onChannel: true,
  });
  /** @param {Channel['kind']} kind */
  const of = (kind) => plant.channels.filter((channel) => channel.kind === kind);
  const actuators = of('actuator').map(site);
  /** @type {Block[]} */
  const first = plant.inputs.length || actuators.length ? [{id: 'actuator', states: [], sites: actuators}] : [];
  const outputs = plant.outputs.map((one) => ({
    name: one.name,
    title: one.description || one.name,
    subject: one.name,
    onChannel: false,
  }));
  return [
    ...first,
    ...middle(plant, of('process'), site),
    {id: 'sensor', states: [], sites: [...of('sensor').map(site), ...outputs]},
  ];
}

/**
 * @param {Plant} plant
 * @param {Channel[]} faults
 * @param {(channel: Channel) => Site} site
 * @returns {Block[]}
 */
function middle(plant, faults, site) {
  const parts = sandwich(plant);
  if (!parts) return [{id: 'plant', states: plant.states.map((one) => one.name), sites: faults.map(site)}];
  /** @param {Channel} channel */
  const behind = (channel) => Object.keys(channel.enters).every((state) => parts.after.includes(state));
  return [
    {id: 'l1', states: parts.before, sites: faults.filter((channel) => !behind(channel)).map(site)},
    {id: 'hysteresis', states: [], sites: []},
    {id: 'l2', states: parts.after, sites: faults.filter(behind).map(site)},
  ];
}

export const WIDTH = 272;
export const HALF = 26; // half the height of a block
const R = 10; // of a site
const PITCH = 23;
const EDGE = 30; // room for u on the left
const SHARE = {actuator: 0.8, plant: 1.25, l1: 0.62, hysteresis: 0.58, l2: 0.62, sensor: 0.76};

/**
 * The positions in a picture that is 272 wide.
 * @param {Plant} plant
 * @returns {Layout}
 */
export function layout(plant) {
  const row = blocks(plant);
  const gap = row.length > 4 ? 9 : 20;
  const left = row[0].id === 'actuator' ? EDGE : 6;
  const room = WIDTH - left - 4 - gap * (row.length - 1);
  const whole = row.reduce((sum, one) => sum + SHARE[one.id], 0);
  let x = left;
  const placed = row.map((one) => {
    const width = (room * SHARE[one.id]) / whole;
    const box = {...one, x, width, columns: Math.max(1, Math.floor((width + 4) / PITCH))};
    x += width + gap;
    return box;
  });
  const rows = Math.max(
    1,
    ...placed.map((one) => Math.ceil(one.sites.filter((site) => site.onChannel).length / one.columns)),
  );
  const top = R + 1 + (rows - 1) * PITCH;
  const half = HALF;
  const axis = top + half + 2;
  const boxes = placed.map((one) => ({...one, y: axis - half, height: 2 * half, top, spots: spots(one, top)}));
  const closed = (plant.controllers ?? []).length > 0;
  const lines = Math.max(plant.inputs.length + (plant.references?.length ?? 0), plant.outputs.length, 1);
  /** @type {Loop | null} */
  const loop = closed ? {x: WIDTH / 2 - 46, y: axis + half + 32, width: 92, height: 34, mark: 55} : null;
  const under = loop ? loop.y + loop.height / 2 : axis + half;
  const foot = under + 12 + 14 * lines + 22; // the names are beside the wires, above the observers
  const last = boxes[boxes.length - 1];
  return {blocks: boxes, axis, foot, height: foot + 24, left, right: last.x + last.width / 2, loop};
}

/**
 * Channel sites in rows on the upper edge, upwards; output sites on the lower edge.
 * @param {Omit<Box, "spots" | "y" | "height" | "top">} box
 * @param {number} top
 * @returns {Spot[]}
 */
function spots(box, top) {
  /**
   * @param {Site[]} sites
   * @param {number} y
   * @param {number} step
   */
  const spread = (sites, y, step) =>
    sites.map((site, place) => {
      const line = Math.floor(place / box.columns);
      const count = Math.min(box.columns, sites.length - line * box.columns);
      const pitch = Math.min(PITCH + 6, box.width / Math.max(count, 1));
      return {
        ...site,
        x: box.x + box.width / 2 + ((place % box.columns) - (count - 1) / 2) * Math.max(PITCH, pitch),
        y: y + line * step,
      };
    });
  const channels = box.sites.filter((site) => site.onChannel);
  const outputs = box.sites.filter((site) => !site.onChannel);
  return [
    ...spread(channels, top, -PITCH),
    ...outputs.map((site, place) => ({
      ...site,
      x: box.x + box.width / 2 + (place - (outputs.length - 1) / 2) * 17,
      y: top + 2 + 2 * HALF,
    })),
  ];
}
