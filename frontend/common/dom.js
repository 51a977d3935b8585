// Small helpers for the document: elements, symbols, numbers. Text is always set as text, never as markup.

import {split, word} from './names.js';

/** @import {Child, ElementOf, Properties} from '../types/dom.js' */

const SVG = new Set(['svg', 'path', 'line', 'rect', 'circle', 'g', 'text', 'title']);

/**
 * Make an element: h('button', {class: 'run', onclick: f}, 'Run'). Properties that are null or false are left out.
 * @template {string} K
 * @param {K} tag
 * @param {Properties<ElementOf<K>>} [properties]
 * @param {...Child} children
 * @returns {ElementOf<K>}
 */
export function h(tag, properties = {}, ...children) {
  const element = SVG.has(tag)
    ? document.createElementNS('http://www.w3.org/2000/svg', tag)
    : document.createElement(tag);
  assign(element, properties);
  element.append(...shown(children));
  return /** @type {ElementOf<K>} */ (element);
}

/**
 * Set attributes, and add event handlers.
 * @param {Element} element
 * @param {object} properties
 */
export function assign(element, properties) {
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name.slice(2), /** @type {EventListener} */ (value));
    else element.setAttribute(name, value === true ? '' : String(value));
  }
}

/**
 * The children that are shown, as `append` takes them.
 * @param {readonly Child[]} children
 * @returns {(Node | string)[]}
 */
export function shown(children) {
  return children.flatMap((child) => {
    if (child instanceof Node) return [child];
    if (typeof child === 'string' || typeof child === 'number') return [String(child)];
    return Array.isArray(child) ? shown(child) : [];
  });
}

/**
 * An italic letter with the hat of an estimate, which sits lower on a letter without ascender.
 * @param {string} letter
 */
export const hatted = (letter) =>
  h('i', {class: `hat${/^[acegm-su-zαγεηικμνοπρστυφχψω]/.test(letter) ? ' low' : ''}`}, letter);

/**
 * A name as mathematics: theta1 becomes an italic θ with the index 1; `hat` puts the hat of an estimate on it.
 * @param {string} name
 * @param {boolean} [hat]
 */
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

/**
 * A number to four significant digits, a power of ten where it is long; '–' where it is missing.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits))).replace('-', '−');
  const [mantissa, power] = value.toExponential(digits - 2).split('e');
  const raised = [...String(Number(power))].map((c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('');
  return `${Number(mantissa)}·10${raised}`.replace('-', '−');
}

/**
 * The first element that a selector matches, which must be there.
 * @param {string} selector
 * @param {ParentNode} [within]
 * @returns {HTMLElement}
 */
export function query(selector, within = document) {
  const element = within.querySelector(selector);
  if (!(element instanceof HTMLElement)) throw new Error(`the page has no ${selector}`);
  return element;
}

/**
 * The drawing context of a canvas.
 * @param {HTMLCanvasElement} canvas
 * @returns {CanvasRenderingContext2D}
 */
export function context(canvas) {
  const ctx = canvas.getContext('2d');
  if (!ctx) throw new Error('this browser cannot draw on a canvas');
  return ctx;
}

/**
 * The children of an element of the page.
 * @param {Element} element
 */
export const childrenOf = (element) => /** @type {HTMLElement[]} */ ([...element.children]);

/**
 * Replace an element's children.
 * @template {Element} E
 * @param {E} element
 * @param {...Child} children
 * @returns {E}
 */
export function fill(element, ...children) {
  element.replaceChildren(...shown(children));
  return element;
}
