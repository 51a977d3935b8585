// The fields of "Figure for a paper", and the options that they set.

import {h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import {Child} from '../../types/dom.js' */

/**
 * @typedef {object} Settings
 * @property {number} width   cm
 * @property {number | null} height   cm; null: by the panels
 * @property {string} font
 * @property {number} size   pt
 * @property {string} colour
 * @property {string} legend
 * @property {string} lang
 * @property {number | null} start   s
 * @property {number | null} end   s
 * @property {string[]} curves   empty: all
 * @property {number[]} panels   empty: all
 * @property {{[curve: string]: string}} styles
 * @property {string} format
 */

/**
 * A row of the form.
 * @param {string} words
 * @param {...Child} children
 */
export const field = (words, ...children) =>
  h('div', {class: 'field'}, h('span', {class: 'soft'}, words), h('span', {class: 'inputs'}, ...children));

/**
 * Buttons of which one is pressed.
 * @param {string} name
 * @param {string[][]} entries   value and words of each
 * @param {string} chosen
 * @param {(value: string) => void} act
 */
export function segments(name, entries, chosen, act) {
  const buttons = entries.map(([value, words]) =>
    h(
      'button',
      {
        type: 'button',
        'aria-pressed': value === chosen ? 'true' : 'false',
        onclick: (event) => {
          for (const one of buttons) one.setAttribute('aria-pressed', String(one === event.currentTarget));
          act(value);
        },
      },
      words,
    ),
  );
  return h('span', {class: 'segments', role: 'group', 'aria-label': name}, buttons);
}

/**
 * The widths of a column and of a page, and a field for any other.
 * @param {number} chosen   cm
 * @param {(width: number) => void} act
 */
export function widths(chosen, act) {
  const usual = segments(
    t('page.paper.width'),
    ['8.5', '17.5'].map((width) => [width, `${width} cm`]),
    String(chosen),
    (width) => {
      input.value = width;
      act(Number(width));
    },
  );
  const other = lengthOrNull(
    t('page.paper.width-cm'),
    'cm',
    (width) => {
      for (const button of usual.querySelectorAll('button'))
        button.setAttribute('aria-pressed', String(parseFloat(button.textContent ?? '') === width));
      if (width !== null && width > 0) act(width);
    },
    chosen,
  );
  const input = /** @type {HTMLInputElement} */ (other.querySelector('input'));
  return [usual, other];
}

/**
 * A list to choose from.
 * @param {string} name
 * @param {string[][]} entries   value and words of each
 * @param {string} chosen
 * @param {(value: string) => void} act
 */
export const choice = (name, entries, chosen, act) =>
  h(
    'select',
    {'aria-label': name, onchange: (event) => act(event.currentTarget.value)},
    entries.map(([value, words]) => h('option', {value, selected: value === chosen}, words)),
  );

/**
 * A field for a number with its unit; empty means null.
 * @param {string} name
 * @param {string} unit
 * @param {(value: number | null) => void} act
 * @param {number | null} [value]
 */
export const lengthOrNull = (name, unit, act, value = null) =>
  h(
    'label',
    {class: 'length'},
    h('input', {
      type: 'number',
      step: 'any',
      'aria-label': name,
      value: value ?? '',
      oninput: (event) => act(event.currentTarget.value === '' ? null : event.currentTarget.valueAsNumber),
    }),
    unit,
  );
