// The strips of a step as it was played on the server: for worksheets and for the preview of a lesson.

import {h} from '../common/dom.js';
import {s} from './svg.js';
import {t} from '../i18n/words.js';

/** @import * as service from '../types/service.js' */

const HEIGHT = 112;
export const LEFT = 52;
export const RIGHT = 8;
const FOOT = 18;

/**
 * The strips of a step.
 * @param {service.Played} played
 * @param {{show?: {strips?: readonly string[]}, run?: {seconds: number} | null}} step
 * @param {{whole?: boolean, width?: number}} [options]   whole: also what happens after the answer; width in px
 */
export function playedStrips(played, step, {whole = true, width = 560} = {}) {
  const names = (step.show?.strips ?? []).filter((name) => played.curves.some(({strip}) => strip === name));
  const labels = [...new Set(played.curves.map(({label}) => label).filter(Boolean))];
  return h(
    'div',
    {class: 'played'},
    names.map((name, place) =>
      h(
        'figure',
        {},
        h('figcaption', {}, nameOf(name), place === 0 && legend(labels)),
        drawStrip(played, name, labels, {whole, width, last: place === names.length - 1}),
      ),
    ),
  );
}

/** The name of a strip in plain characters. @param {string} name */
export const nameOf = (name) => {
  const [kind, rest] = [name.slice(0, name.indexOf('.')), name.slice(name.indexOf('.') + 1)];
  return kind === 'residual' ? `${rest} − ŷ` : rest;
};

/** @param {string[]} labels */
const legend = (labels) =>
  h(
    'span',
    {class: 'played-legend'},
    labels.map((label, place) => h('span', {style: `color:var(--o${place % 7})`}, '— ', label)),
  );

/**
 * @param {service.Played} played
 * @param {string} name
 * @param {string[]} labels
 * @param {{whole: boolean, width: number, last: boolean}} options
 */
function drawStrip(played, name, labels, {whole, width, last}) {
  const curves = played.curves.filter(({strip}) => strip === name);
  const [t0, t1] = [played.t[0] ?? 0, played.t[played.t.length - 1] ?? 1];
  const shown = (/** @type {number} */ time) => whole || time <= played.mark + 1e-6;
  const all = curves.flatMap(({values}) => values.filter((value, i) => value !== null && shown(played.t[i])));
  const known = /** @type {number[]} */ (all);
  let [low, high] = known.length ? [Math.min(...known), Math.max(...known)] : [0, 1];
  const margin = 0.1 * (high - low) || 0.1 * Math.abs(high) || 1;
  [low, high] = [low - margin, high + margin];
  const high1 = HEIGHT - (last ? FOOT : 0);
  const x = (/** @type {number} */ time) => LEFT + ((time - t0) / (t1 - t0 || 1)) * (width - LEFT - RIGHT);
  const y = (/** @type {number} */ value) => 4 + ((high - value) / (high - low)) * (high1 - 8);
  const edge = x(Math.min(t1, Math.max(t0, played.mark)));
  return s(
    'svg',
    {viewBox: `0 0 ${width} ${HEIGHT}`, class: 'played-strip', role: 'img', 'aria-label': nameOf(name)},
    s('rect', {x: LEFT, y: 4, width: width - LEFT - RIGHT, height: high1 - 8, class: 'frame'}),
    !whole && s('rect', {x: edge, y: 4, width: Math.max(0, width - RIGHT - edge), height: high1 - 8, class: 'unknown'}),
    s('path', {d: `M${edge} 4V${high1 - 4}`, class: 'now'}),
    [low + margin, high - margin].map((value) =>
      s(
        'text',
        {x: LEFT - 6, y: y(value) + 4, 'text-anchor': 'end'},
        String(Number(value.toPrecision(3))).replace('-', '−'),
      ),
    ),
    last &&
      [t0, played.mark, t1].map((time, place, times) =>
        place > 0 && x(time) - x(times[place - 1]) < 30
          ? null
          : s('text', {x: x(time), y: HEIGHT - 3, 'text-anchor': place ? 'end' : 'start'}, `${Math.round(time)} s`),
      ),
    curves.map(({label, values}) =>
      s('path', {
        d: pathOf(played.t, values, shown, x, y),
        class: label ? 'curve' : 'curve truth',
        style: label ? `stroke:var(--o${labels.indexOf(label) % 7})` : '',
      }),
    ),
    s('title', {}, t('page.played.strip', {strip: nameOf(name)})),
  );
}

/**
 * @param {readonly number[]} times
 * @param {readonly (number | null)[]} values
 * @param {(time: number) => boolean} shown
 * @param {(time: number) => number} x
 * @param {(value: number) => number} y
 */
function pathOf(times, values, shown, x, y) {
  let path = '';
  let pen = 'M';
  values.forEach((value, i) => {
    if (value === null || !shown(times[i])) return (pen = 'M');
    path += `${pen}${x(times[i]).toFixed(1)} ${y(value).toFixed(1)}`;
    pen = 'L';
    return pen;
  });
  return path;
}
