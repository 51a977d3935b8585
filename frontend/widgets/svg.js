// SVG elements, icons, and symbols set as SVG text.

import {assign, shown} from '../common/dom.js';
import {GREEK, split, word} from '../common/names.js';

/** @import {Child, Properties} from '../types/dom.js' */

const SPACE = 'http://www.w3.org/2000/svg';

/**
 * Make an SVG element: s('path', {d: …}, children). Properties that are null or false are left out.
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} tag
 * @param {Properties<SVGElementTagNameMap[K]>} [properties]
 * @param {...Child} children
 * @returns {SVGElementTagNameMap[K]}
 */
export function s(tag, properties = {}, ...children) {
  const element = document.createElementNS(SPACE, tag);
  assign(element, properties);
  element.append(...shown(children));
  return element;
}

const ICONS = {
  share:
    'M6 9.500l4-2.300M6 6.500L10 8.800M4.200 10a2 2 0 1 0 0-4 2 2 0 0 0 0 4z' +
    'M11.800 5.800a2 2 0 1 0 0-3.600 2 2 0 0 0 0 3.600zM11.800 13.800a2 2 0 1 0 0-3.600 2 2 0 0 0 0 3.600z',
  export: 'M8 2.500v7.500M5 7l3 3 3-3M3 13.500h10',
  close: 'M4 4l8 8M12 4l-8 8',
  edit: 'M3 13l.800-3L10.500 3.300l2.200 2.200L6 12.200zM9 4.800l2.200 2.200',
  down: 'M4.500 6.500L8 10l3.500-3.500',
  back: 'M3 8a5 5 0 1 1 1.500 3.500M3 12.500V9h3.500',
  go: 'M5 3.500v9L12 8z',
  screen: 'M2.500 3.500h11v7.500h-11zM8 11v2.500M5.500 13.500h5',
  help: 'M6 6.200a2 2 0 1 1 3 1.700c-.7.400-1 .8-1 1.600M8 11.800v.1',
  link: 'M6.500 9.500l3-3M7 5l1.500-1.500a2.500 2.500 0 0 1 4 4L11 9M9 11l-1.500 1.500a2.500 2.500 0 0 1-4-4L5 7',
  theme: 'M8 2.500a5.500 5.500 0 0 1 0 11z',
};

/**
 * One of the page's icons, 16 × 16, in the colour of the text around it.
 * @param {keyof typeof ICONS} name
 * @param {number} [size]
 */
export function icon(name, size = 15) {
  return s(
    'svg',
    {
      viewBox: '0 0 16 16',
      style: `width:${size / 13.5}rem;height:${size / 13.5}rem`,
      fill: 'none',
      stroke: 'currentColor',
      'stroke-width': 1.5,
      'stroke-linecap': 'round',
      'stroke-linejoin': 'round',
      'aria-hidden': 'true',
      class: 'icon',
    },
    s('path', {d: ICONS[name]}),
    name === 'theme' && [s('circle', {cx: 8, cy: 8, r: 5.5}), s('path', {d: ICONS.theme, fill: 'currentColor'})],
  );
}

/**
 * A name as mathematics within SVG text: tspans, the index lower and smaller.
 * @param {string} name
 * @param {number} [size]
 */
export function letters(name, size = 13) {
  const [base, index] = split(name);
  const worded = base.length > 1 && !Object.values(GREEK).includes(base);
  const letter = s('tspan', {class: worded ? 'word' : 'letter'}, word(base));
  if (!index) return [letter];
  return [
    letter,
    s('tspan', {dy: size * 0.22, 'font-size': size * 0.7, class: 'index'}, word(index)),
    s('tspan', {dy: -size * 0.22, 'font-size': size}, '\u200b'),
  ];
}
