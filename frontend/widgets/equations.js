// The equations of the plant and of the observers that watch it, as MathML from the server.

import {post, reason} from '../common/api.js';
import {fill, h, symbol} from '../common/dom.js';
import {focusWhenScrolling} from '../common/scroll-focus.js';
import {chip} from './controls.js';
import {named, t} from '../i18n/words.js';

/** @import {Plant} from '../pages/types.js' */
/** @import {App, ObserverState} from '../live/types.js' */
/** @import * as service from '../types/service.js' */

const ALLOWED = new Set([
  'math',
  'mrow',
  'mi',
  'mn',
  'mo',
  'mtext',
  'msub',
  'msup',
  'msubsup',
  'mover',
  'munder',
  'munderover',
  'mstyle',
  'mfrac',
  'msqrt',
  'mspace',
  'mtable',
  'mtr',
  'mtd',
]);
const SPACE = 'http://www.w3.org/1998/Math/MathML';
const KEPT = new Set([
  'class',
  'display',
  'accent',
  'stretchy',
  'fence',
  'form',
  'lspace',
  'rspace',
  'width',
  'mathvariant',
  'columnalign',
  'columnspacing',
]);

/**
 * MathML text as elements; only elements and attributes of mathematics are taken over.
 * @param {string} text
 */
export function mathml(text) {
  const source = new DOMParser().parseFromString(text, 'application/xml').documentElement;
  return copy(source);
}

/** @param {Node} node @returns {Element | Text} */
function copy(node) {
  if (node instanceof Text) return document.createTextNode(node.data);
  if (!(node instanceof Element) || !ALLOWED.has(node.localName)) return document.createTextNode('');
  const element = document.createElementNS(SPACE, node.localName);
  for (const {name, value} of node.attributes) if (KEPT.has(name)) element.setAttribute(name, value);
  element.append(...[...node.childNodes].map(copy));
  return element;
}

/** @param {HTMLElement} body @param {App} app */
export async function showEquations(body, app) {
  const {plant, observers} = app.state;
  if (!plant) return;
  fill(body, h('p', {class: 'soft'}, t('page.text.loading')));
  try {
    /** @type {service.Equations} */
    const answer = await post('/api/equations', {plant, observers: [...new Set(observers.map((one) => one.kind))]});
    fill(
      body,
      plantPart(answer.plant, plant),
      observers.map((one) => observerPart(one, answer.observers[one.kind])),
    );
  } catch (error) {
    fill(body, h('p', {class: 'alarm'}, reason(error).message));
  }
}

/** @param {service.PlantEquations} answer @param {Plant} plant */
function plantPart(answer, plant) {
  /** @param {service.EquationLine[]} items */
  const lines = (items) =>
    focusWhenScrolling(
      h(
        'div',
        {class: 'equations'},
        items.map((item) =>
          h(
            'div',
            {class: 'equation'},
            mathml(item.math),
            h('span', {class: 'soft'}, [named(item.description), item.unit].filter(Boolean).join(', ')),
          ),
        ),
      ),
    );
  const faults = plant.channels.map((channel) =>
    h(
      'li',
      {},
      symbol(channel.name),
      ' ',
      named(channel.title) || channel.name,
      h('span', {class: 'soft'}, ` ${t(`page.fault.kind.${channel.kind}`)}`),
    ),
  );
  return h(
    'section',
    {},
    h('h3', {}, named(plant.title) || plant.id),
    plant.source && h('p', {class: 'soft'}, named(plant.source)),
    lines(answer.states),
    answer.definitions.length > 0 && [h('h4', {}, t('page.equations.with')), lines(answer.definitions)],
    h('h4', {}, t('page.equations.measured')),
    lines(answer.outputs),
    answer.controllers.length > 0 && [h('h4', {}, t('page.equations.controllers')), lines(answer.controllers)],
    faults.length > 0 && [h('h4', {}, t('page.equations.faults')), h('ul', {class: 'where'}, faults)],
    plant.time.kind === 'discrete' && h('p', {class: 'soft'}, t('page.equations.next-sample', {s: plant.time.period})),
  );
}

/** @param {ObserverState} observer @param {service.ObserverEquations} answer */
function observerPart(observer, answer) {
  return h(
    'section',
    {},
    h('h3', {}, chip(observer.colour), observer.label, h('span', {class: 'soft'}, ` ${named(answer.title)}`)),
    h('p', {class: 'soft'}, answer.source),
    focusWhenScrolling(
      h(
        'div',
        {class: 'equations'},
        answer.equations.map(({number, math}) =>
          h('div', {class: 'equation'}, mathml(math), h('span', {class: 'soft'}, number)),
        ),
      ),
    ),
    answer.where.length > 0 &&
      h(
        'ul',
        {class: 'where'},
        answer.where.map(({math, text: words}) => {
          const sign = mathml(math);
          if (sign instanceof Element) sign.removeAttribute('display');
          return h('li', {}, sign, h('span', {}, ` ${named(words)}`));
        }),
      ),
  );
}
