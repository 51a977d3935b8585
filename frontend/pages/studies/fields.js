// Fields of the form: a line with its label, a number of things; and the form as a file.

import {fill, h} from '../../common/dom.js';

/** @import {Child} from '../../types/dom.js' */

/** @param {string} label @param {...Child} parts */
export const line = (label, ...parts) =>
  h('div', {class: 'study-line'}, h('span', {class: 'soft'}, label), h('div', {}, parts));

/**
 * A field for a whole number above zero.
 * @param {number} value
 * @param {string} label
 * @param {(value: number) => void} set
 */
export function countField(value, label, set) {
  const field = h('input', {
    type: 'number',
    min: 1,
    step: 1,
    value,
    'aria-label': label,
    oninput: () => {
      if (field.valueAsNumber >= 1) set(Math.floor(field.valueAsNumber));
    },
  });
  return field;
}

/** Save data as a file. @param {string} name @param {unknown} data */
export function saveFile(name, data) {
  const blob = new Blob([JSON.stringify(data, null, 1)], {type: 'application/json'});
  const link = h('a', {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/**
 * Fill a form anew without taking the focus from the field in which somebody types.
 * @param {HTMLElement} root @param {...Child} parts
 */
export function refill(root, ...parts) {
  const fields = () => [...root.querySelectorAll('input, select, button')];
  const place = fields().findIndex((one) => one === document.activeElement);
  fill(root, ...parts);
  const next = fields()[place];
  if (next instanceof HTMLElement) next.focus();
}
