// The controllers of a plant in its picture: readings and set points enter them, and they set the input.

import {letters, s} from '../../../widgets/svg.js';
import {t} from '../../../i18n/words.js';
import {WIDTH} from './diagram.js';

/** @import {Plant} from '../../../pages/types.js' */
/** @import {App} from '../../types.js' */
/** @import {Layout, Loop} from './diagram.js' */
/** @import {Limited} from './plant.js' */

const TIP = 'url(#tip)';

/**
 * The controllers with their wires, and the mark of the saturation.
 * @param {Layout} place
 * @param {Loop} loop
 * @param {Plant} plant
 * @param {App} app
 */
export function controllers({axis, left, right, foot}, loop, plant, app) {
  const {x, y, width, height} = loop;
  const u = 13;
  /** @param {string} d @param {boolean} [arrow] */
  const wire = (d, arrow = true) => s('path', {class: 'wire', d, ...(arrow ? {'marker-end': TIP} : {})});
  const middle = WIDTH / 2;
  const curve = s('path', {class: 'curve', d: `M${loop.mark - 8} ${y + 5}h4l8 -10h4`});
  const limits = limitsOf(plant, app);
  const label = s('title', {}, t('page.plant.saturation'));
  const mark = s('g', {class: 'limit'}, label, s('rect', {class: 'blk', ...around(loop.mark, y)}), curve);
  const parts = [
    wire(`M${u} ${y}V${axis}H${left - 1}`),
    wire(`M${right} ${y}H${x + width + 1}`),
    s('circle', {cx: right, cy: y, r: 1.8, class: 'knot'}),
    s('circle', {cx: u, cy: y, r: 1.8, class: 'knot'}),
    ...(limits.length
      ? [wire(`M${x} ${y}H${loop.mark + 13}`), wire(`M${loop.mark - 12} ${y}H${u}`, false), mark]
      : [wire(`M${x} ${y}H${u}`, false)]),
    s('rect', {class: 'blk', x, y: y - height / 2, width, height, rx: 6}),
    s('text', {class: 't', x: middle, y: y - 3}, t('page.plant.block.controller', {n: plant.controllers.length})),
    s('text', {class: 'ts', x: middle, y: y + 11}, pace(plant)),
    plant.references.length > 0 && wire(`M${middle} ${foot - 27}V${y + height / 2 + 1}`),
  ];
  return {parts: parts.filter(Boolean), limits: limits.map((one) => ({...one, mark, label}))};
}

/** @param {number} x @param {number} y */
const around = (x, y) => ({x: x - 12, y: y - 9, width: 24, height: 18, rx: 3});

/**
 * The name of the only controller, and how often the controllers work.
 * @param {Plant} plant
 */
function pace(plant) {
  const [first, ...others] = plant.controllers;
  const periods = [...new Set(plant.controllers.map(({period}) => period))];
  const often =
    periods.length > 1
      ? ''
      : periods[0] === null
        ? t('page.plant.continuous')
        : t('page.plant.every', {s: String(periods[0])});
  const name = others.length === 0 && first.name.length < 7 ? [...letters(first.name, 12), often && ' · '] : [];
  return [...name, often];
}

/**
 * The limits of the inputs that controllers set, as numbers.
 * @param {Plant} plant
 * @param {App} app
 * @returns {Pick<Limited, 'column' | 'low' | 'high'>[]}
 */
function limitsOf(plant, app) {
  const parameters = {
    ...Object.fromEntries(plant.parameters.map((one) => [one.name, one.value])),
    ...app.state.spec?.parameters,
  };
  /** @param {number | string | null} limit @param {number} open */
  const read = (limit, open) => (typeof limit === 'string' ? parameters[limit] : (limit ?? open));
  return plant.controllers
    .flatMap(({outputs}) => outputs)
    .filter(({saturation}) => saturation.some((limit) => limit !== null))
    .map(({input, saturation: [low, high]}) => ({
      column: `u.${input}`,
      low: read(low, -Infinity),
      high: read(high, Infinity),
    }));
}

/**
 * Whether a value is at one of the limits.
 * @param {Limited} limited
 * @param {number} value
 */
export const atLimit = ({low, high}, value) => value <= low || value >= high;
