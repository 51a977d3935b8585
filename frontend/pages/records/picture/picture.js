// Strips over one axis of time: curves, bands, and marks that are buttons. Everything but the curves is placed in
// per cent, so that the picture follows the width of the page by itself.

import {h, number} from '../../../common/dom.js';
import {marks as multiples, niceStep} from '../../../live/scope/axes.js';
import {seconds} from '../../../widgets/number-format.js';
import {HEIGHT, WIDTH, apart, area, heights, line as curve, path, range, rangeOfCurves, widened} from './curves.js';

/** @import {Band, Mark, Strip} from '../types.js' */
/** @import {Child} from '../../../types/dom.js' */

const APART = 0.028; // of the width, between two marks

/**
 * A place in per cent, limited to the picture.
 * @param {number} share
 */
const percent = (share) => `${(100 * Math.min(1, Math.max(0, share))).toFixed(3)}%`;

/**
 * @param {object} content
 * @param {number} content.duration   s
 * @param {readonly Strip[]} content.strips
 * @param {readonly Band[]} [content.bands]
 * @param {readonly Mark[]} [content.marks]
 * @param {Child} [content.over]   elements over all strips, placed in per cent
 * @param {string} content.label
 */
export function picture({duration, strips, bands = [], marks = [], over = null, label}) {
  const end = duration || 1;
  const ticks = timeTicks(end);
  return h(
    'div',
    {class: 'picture', role: 'group', 'aria-label': label, style: `--n:${strips.length}`},
    strips.map((strip, k) => [
      h(
        'div',
        {class: 'strip-name', title: strip.title, style: `--k:${k}`},
        h('span', {class: 'strip-label'}, strip.label),
        h('small', {}, [strip.title, strip.unit].filter(Boolean).join(', ')),
      ),
      plot(strip, k, ticks, marksOf(marks, strip.key, end), end),
    ]),
    h(
      'div',
      {class: 'over'},
      bands.map((band) =>
        h('div', {
          class: `band ${band.kind}`,
          title: band.title,
          style: `left:${percent(band.from / end)};width:${percent((Math.min(band.to, end) - band.from) / end)}`,
        }),
      ),
      over,
    ),
    h(
      'div',
      {class: 'times', 'aria-hidden': 'true'},
      ticks.map((at) => h('span', {style: `left:${percent(at / end)}`}, at === 0 ? '0 s' : seconds(at, ticks[1]))),
    ),
  );
}

/** @param {number} end */
function timeTicks(end) {
  return multiples(0, end, niceStep(end, 6));
}

/**
 * The marks of a strip and their shares of the width.
 * @param {readonly Mark[]} marks
 * @param {string} key
 * @param {number} end
 */
function marksOf(marks, key, end) {
  const own = marks.filter((one) => one.strip === key);
  const places = apart(
    own.map((one) => Math.min(0.99, Math.max(0.01, one.t / end))),
    APART,
  );
  return own.map((mark, index) => ({mark, place: places[index]}));
}

/**
 * @param {Strip} strip
 * @param {number} k   its place
 * @param {number[]} times
 * @param {{mark: Mark, place: number}[]} marks
 * @param {number} end
 */
function plot(strip, k, times, marks, end) {
  const {low, high, logarithmic = false, line, most, second, curves = [], limits: sides} = strip;
  const own = low.length ? range(low, high, {line: line?.at, most, logarithmic}) : rangeOfCurves(curves, strip.zero);
  const limits = [second, ...(low.length ? curves : [])].reduce(
    (wide, one) => (one ? widened(wide, one.values) : wide),
    own,
  );
  const height = heights(limits, logarithmic);
  return h(
    'div',
    {class: `plot${strip.small ? ' small-plot' : ''}`, 'data-strip': strip.key, style: `--k:${k}`},
    h(
      'svg',
      {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', 'aria-hidden': 'true'},
      times.map((at) => h('line', {class: 'grid', x1: (at / end) * WIDTH, x2: (at / end) * WIDTH, y1: 0, y2: HEIGHT})),
      line && h('line', {class: 'threshold', x1: 0, x2: WIDTH, y1: height(line.at), y2: height(line.at)}),
      sides !== undefined &&
        [-sides, sides].map((at) => h('line', {class: 'side', x1: 0, x2: WIDTH, y1: height(at), y2: height(at)})),
      curves.map(
        ({t, low: lower, high: upper, colour}) =>
          lower &&
          upper &&
          h('path', {class: 'curve-band', style: `--c:${colour}`, d: area(t, lower, upper, end, height)}),
      ),
      low.length > 0 &&
        h('path', {
          class: second || curves.length > 0 ? 'measured' : null,
          d: path(low, high, height, strip.held, strip.bridged),
        }),
      second && h('path', {class: 'simulated', d: curve(second.t, second.values, end, height)}),
      curves.map(({t, values, colour, dashed}) =>
        h('path', {
          class: dashed ? 'curve dashed' : 'curve',
          style: `--c:${colour}`,
          d: curve(t, values, end, height),
        }),
      ),
    ),
    valueTicks(limits, logarithmic).map((at) =>
      h('span', {class: 'value', style: `top:${height(at)}%`, 'aria-hidden': 'true'}, number(at, 3)),
    ),
    line && h('span', {class: 'line-title', style: `top:${height(line.at)}%`}, line.title),
    marks.map(({mark, place}) => markButton(mark, place)),
  );
}

/** @param {[number, number]} limits @param {boolean} logarithmic */
function valueTicks([low, high], logarithmic) {
  if (!logarithmic) {
    const all = multiples(low, high, niceStep(high - low, 3));
    return all.filter((at) => at > low + 0.05 * (high - low) && at < high - 0.05 * (high - low));
  }
  const [first, last] = [Math.ceil(Math.log10(low)), Math.floor(Math.log10(high))];
  const powers = Array.from({length: Math.max(0, last - first + 1)}, (_, k) => 10 ** (first + k));
  return powers.length > 3 ? powers.filter((_, k) => k % 2 === (powers.length + 1) % 2) : powers;
}

/** @param {Mark} mark @param {number} place */
const markButton = ({sign, title, kind, id}, place) =>
  h(
    id ? 'button' : 'span',
    {
      class: `mark ${kind}`,
      style: `left:${percent(place)}`,
      title,
      type: id ? 'button' : null,
      role: id ? null : 'img',
      'aria-label': title,
      'data-finding': id,
    },
    sign,
  );
