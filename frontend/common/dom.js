// Small helpers for the document: elements, symbols, numbers. Text is always set as text, never as markup.

import {split, word} from './names.js';

/** An element: h('button', {class: 'run', onclick: f}, 'Run'). Properties that are null or false are left out. */
export function h(tag, properties = {}, ...children) {
  const element =
    tag === 'svg' || SVG.has(tag)
      ? document.createElementNS('http://www.w3.org/2000/svg', tag)
      : document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(
    ...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false),
  );
  return element;
}
const SVG = new Set(['path', 'line', 'rect', 'circle', 'g', 'text', 'title']);

/** An italic letter with the hat of an estimate, which sits lower on a letter without ascender. */
export const hatted = (letter) =>
  h('i', {class: `hat${/^[acegm-su-zαγεηικμνοπρστυφχψω]/.test(letter) ? ' low' : ''}`}, letter);

/** A name as mathematics: theta1 becomes an italic θ with the index 1; `hat` puts the hat of an estimate on it. */
export function symbol(name, hat = false) {
  const [base, index] = split(name);
  const letter = word(base);
  return h(
    'span',
    {class: 'math'},
    hat ? hatted(letter) : h('i', {class: letter.length > 1 && 'word'}, letter),
    index && h('sub', {}, word(index)),
  );
}

/** A number to four significant digits, powers of ten as such. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits))).replace('-', '−');
  const [mantissa, power] = value.toExponential(digits - 2).split('e');
  const raised = [...String(Number(power))].map((c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('');
  return `${Number(mantissa)}·10${raised}`.replace('-', '−');
}

/** Replace an element's children. */
export function fill(element, ...children) {
  element.replaceChildren(
    ...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false),
  );
  return element;
}
