// The set points of the controllers: one slider each, moved while time runs.

import {h, symbol} from '../../../common/dom.js';
import {called} from '../../../common/names.js';
import {linear} from '../../../widgets/slider-scale.js';
import {slider, throttled} from '../../../widgets/controls.js';
import {named, t} from '../../../i18n/words.js';

/** @import {Plant} from '../../../pages/types.js' */
/** @import {App} from '../../types.js' */

/**
 * A row for every reference of a plant, and a function that ends their subscriptions.
 * @param {Plant} plant
 * @param {App} app
 * @returns {{elements: HTMLElement[], end: () => void}}
 */
export function setPoints(plant, app) {
  const rows = (plant.references ?? []).map((reference) => row(reference, plant, app));
  return {elements: rows.map(({element}) => element), end: () => rows.forEach((one) => one.end())};
}

/**
 * @param {Plant['references'][number]} reference
 * @param {Plant} plant
 * @param {App} app
 */
function row({name, unit, bounds, default: usual, description}, plant, app) {
  const now = () => {
    const value = app.latest(`r.${name}`);
    return Number.isFinite(value) ? value : usual;
  };
  const reach = 2 * Math.abs(usual) || 1;
  const [low, high] = bounds;
  let sent = -1; // rows when the last command was sent
  const send = throttled(async (/** @type {number} */ value) => {
    try {
      await app.send({type: 'set-signal', name, signal: {kind: 'constant', value}});
    } catch (error) {
      app.act.refused(error);
      control.show(now());
    }
  });
  const words = t('page.plant.set-point', {name: called(name, plant)});
  const control = slider({
    name: words,
    scale: linear(low ?? usual - reach, high ?? usual + reach),
    value: now(),
    change: (value) => {
      sent = app.samples.rows;
      send(value);
    },
  });
  const element = h(
    'div',
    {class: 'set-point', role: 'group', 'aria-label': words, title: named(description)},
    h('span', {class: 'name'}, t('page.plant.set-point-short'), ' ', symbol(name)),
    control.range,
    control.field,
    h('small', {}, unit),
  );
  const ends = [
    app.onTick(() => {
      if (app.samples.rows > sent + 1) control.follow(now());
    }),
    app.subscribe(
      (state) => state.role,
      (role) => control.disable(role === 'view'),
    ),
  ];
  return {element, end: () => ends.forEach((end) => end())};
}
