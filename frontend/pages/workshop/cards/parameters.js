// Parameters and initial states with sliders: moving one moves the cards, and the text when it is written there.

import {fill, h, number, symbol} from '../../../common/dom.js';
import {named, t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */
/** @import {ShopActions, ShopStore} from '../types.js' */

const MOST = 10;

/**
 * @param {{head: HTMLElement, body: HTMLElement}} card
 * @param {ShopStore} store
 * @param {ShopActions} act
 */
export function mountParameters(card, store, act) {
  const write = h(
    'button',
    {type: 'button', class: 'link', onclick: () => act.edit({values: values(store)})},
    t('page.workshop.write'),
  );
  const reset = h(
    'button',
    {
      type: 'button',
      class: 'link',
      onclick: () => store.set({tried: {...store.state.tried, parameters: {}, initial: {}}}),
    },
    t('page.workshop.reset'),
  );
  card.head.append(h('span', {class: 'links'}, reset, write));
  let all = false;
  const draw = () => {
    const plant = store.state.good?.plant;
    if (!plant) return fill(card.body);
    const rows = [
      ...plant.parameters.map((one) => row(store, one.name, symbol(one.name), one.value, one, 'parameters')),
      ...plant.states.map((one) =>
        row(
          store,
          one.name,
          [symbol(one.name), h('span', {class: 'soft'}, '(0)')],
          one.initial,
          {...one, bounds: one.domain},
          'initial',
        ),
      ),
    ];
    const more = rows.length - MOST;
    return fill(
      card.body,
      all ? rows : rows.slice(0, MOST),
      more > 0 &&
        !all &&
        h(
          'button',
          {
            type: 'button',
            class: 'link',
            onclick: () => {
              all = true;
              draw();
            },
          },
          t('page.workshop.more', {n: more}),
        ),
      h('p', {class: 'soft'}, t('page.workshop.parameters.about')),
    );
  };
  store.subscribe((state) => state.good, draw);
  store.subscribe(
    (state) => state.tried,
    ({tried}) => {
      const moved = Object.keys(tried.parameters).length + Object.keys(tried.initial).length > 0;
      write.hidden = !moved;
      reset.hidden = !moved;
      if (!moved) draw();
    },
  );
}

/**
 * @param {ShopStore} store
 * @param {string} name
 * @param {import('../../../types/dom.js').Child} sign
 * @param {number} begin
 * @param {{unit: string, description: string, bounds: (number | null)[]}} item
 * @param {'parameters' | 'initial'} group
 */
function row(store, name, sign, begin, {unit, description, bounds: [least, most]}, group) {
  const present = store.state.tried[group][name] ?? begin;
  const [low, high] = range(begin, least, most);
  const shown = h('output', {class: 'num'}, number(present));
  const input = h('input', {
    type: 'range',
    min: low,
    max: high,
    step: (high - low) / 200,
    'aria-label': [named(description) || name, unit].filter(Boolean).join(', '),
    oninput: () => {
      const value = Number(Number(input.value).toPrecision(3));
      shown.textContent = number(value);
      const {tried} = store.state;
      store.set({tried: {...tried, [group]: {...tried[group], [name]: value}}});
    },
  });
  input.value = String(present);
  return h(
    'label',
    {class: 'par', title: named(description)},
    h('span', {class: 'sign'}, sign),
    input,
    shown,
    h('span', {class: 'u'}, unit),
  );
}

/**
 * The range of a slider: half to twice the value, within its bounds.
 * @param {number} value
 * @param {number | null} least
 * @param {number | null} most
 * @returns {[number, number]}
 */
export function range(value, least, most) {
  const size = Math.abs(value) || (most !== null && least !== null ? (most - least) / 2 : 1);
  let low = value ? Math.min(value / 2, value * 2) : -size;
  let high = value ? Math.max(value / 2, value * 2) : size;
  if (least !== null) low = Math.max(low, least);
  if (most !== null) high = Math.min(high, most);
  return low < high ? [low, high] : [value - size / 2, value + size / 2];
}

/** The new values by their path in the text. @param {ShopStore} store */
function values({state}) {
  /** @type {{[path: string]: number}} */
  const paths = {};
  const plant = state.good?.plant;
  if (!plant) return paths;
  plant.parameters.forEach((one, place) => {
    if (one.name in state.tried.parameters) paths[`parameters[${place}].value`] = state.tried.parameters[one.name];
  });
  plant.states.forEach((one, place) => {
    if (one.name in state.tried.initial) paths[`states[${place}].initial`] = state.tried.initial[one.name];
  });
  return paths;
}
