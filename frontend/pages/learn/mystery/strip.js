// One strip over the whole record: curves up to a time, what has not happened yet, lines and areas, as SVG.

import {fill, h, number} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';

/** @import {Child} from '../../../types/dom.js' */

/**
 * @typedef {object} Curve
 * @property {readonly (number | null)[]} values   one for each row
 * @property {string} look   class of its stroke
 */
/** @typedef {{t: number, look: string, words?: string, row?: number, before?: boolean}} Line */
/** @typedef {{from: number, to: number, look: string}} Area */
/**
 * @typedef {object} Content
 * @property {Curve[]} curves
 * @property {number} shown    time in s up to which the curves are known
 * @property {Line[]} [lines]
 * @property {Area[]} [areas]
 */

const TOP = 6;
const FOOT = 20; // px of the time axis
const LEFT = 46; // px of the numbers
const HATCH = 7; // px between slanted lines

export class Strip {
  /**
   * @param {{label: Child, words: string, end: number, record: number, height: number, least: number, axis: boolean,
   *   point?: (t: number) => void}} options   `least`: half height of the range at least; `point`: called with a time
   *   that was pointed at
   */
  constructor(options) {
    this.options = options;
    this.width = 600;
    this.svg = h('svg', {class: 'strip-svg', role: 'img', 'aria-label': options.words});
    this.element = h('div', {class: 'strip'}, h('div', {class: 'strip-label'}, options.label), this.svg);
    /** @type {Content | null} */
    this.content = null;
    new ResizeObserver(([entry]) => {
      this.width = Math.max(200, entry.contentRect.width);
      if (this.content) this.draw(this.content);
    }).observe(this.svg);
    const {point} = options;
    if (point)
      this.svg.addEventListener('pointerdown', (event) => {
        const x = event.clientX - this.svg.getBoundingClientRect().left;
        point(((x - LEFT) / (this.width - LEFT)) * options.end);
      });
  }

  /** @param {Content} content */
  draw(content) {
    this.content = content;
    const {width} = this;
    const {end, record, height, least, axis} = this.options;
    const {curves, shown, lines = [], areas = []} = content;
    const rows = Math.min(Math.floor(shown / record + 1e-6) + 1, curves[0]?.values.length ?? 0);
    const bottom = height - (axis ? FOOT : 4);
    const [low, high] = range(curves, rows, least);
    /** @param {number} time */
    const x = (time) => LEFT + (time / end) * (width - LEFT - 1);
    /** @param {number} value */
    const y = (value) => TOP + ((high - value) / (high - low)) * (bottom - TOP);
    const inside = {y: TOP, height: bottom - TOP};
    this.svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.svg.setAttribute('height', String(height));
    fill(
      this.svg,
      areas.map(({from, to, look}) =>
        look === 'untold'
          ? h('path', {class: look, d: hatching(x(from), x(to), TOP, bottom)})
          : h('rect', {class: look, x: x(from), width: Math.max(0, x(to) - x(from)), ...inside}),
      ),
      shown < end && h('rect', {class: 'unknown', x: x(shown), width: x(end) - x(shown), ...inside}),
      h('rect', {class: 'frame', x: LEFT, width: width - LEFT - 1, ...inside}),
      steps(low, high, 3).map((value) => [
        h('line', {class: 'grid', x1: LEFT, x2: width - 1, y1: y(value), y2: y(value)}),
        h('text', {class: 'tick', x: LEFT - 7, y: y(value) + 4, 'text-anchor': 'end'}, number(value, 3)),
      ]),
      curves.map(({values, look}) =>
        h('path', {
          class: `curve ${look}`,
          d: path(values, rows, (row) => x(row * record), y),
        }),
      ),
      lines.map((line) => this.line(line, x(line.t), bottom)),
      axis &&
        steps(0, end, width > 500 ? 7 : 4).map((time) =>
          h(
            'text',
            {class: 'tick', x: Math.min(x(time), width - 14), y: height - 5, 'text-anchor': 'middle'},
            time === 0 ? '0 s' : number(time, 4),
          ),
        ),
      shown < 0.7 * end &&
        h('text', {class: 'later', x: (x(shown) + width) / 2, y: (TOP + bottom) / 2 + 4}, t('page.mystery.not-yet')),
    );
  }

  /** @param {Line} line @param {number} x @param {number} bottom */
  line({look, words, row = 0, before}, x, bottom) {
    const left = before ?? x > this.width - 130;
    return [
      h('line', {class: `mark-line ${look}`, x1: x, x2: x, y1: TOP, y2: bottom}),
      words &&
        h(
          'text',
          {
            class: `mark-words ${look}`,
            x: left ? x - 7 : x + 7,
            y: TOP + 14 + 16 * row,
            'text-anchor': left ? 'end' : 'start',
          },
          words,
        ),
    ];
  }
}

/**
 * The range of the rows that are known; it grows in steps, so that it does not say what will come.
 * @param {Curve[]} curves
 * @param {number} rows
 * @param {number} least
 * @returns {[number, number]}
 */
function range(curves, rows, least) {
  let [low, high] = [Infinity, -Infinity];
  for (const {values} of curves)
    for (let row = 0; row < rows; row += 1) {
      const value = values[row];
      if (value === null) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  if (!(low <= high)) return [-least, least];
  const middle = (low + high) / 2;
  [low, high] = [Math.min(low, middle - least), Math.max(high, middle + least)];
  const step = rounded((high - low) / 4);
  return [Math.floor(low / step) * step, Math.ceil(high / step) * step];
}

/** The next of 1, 2, 5, 10 … above a number. @param {number} value */
function rounded(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 2, 5].find((one) => value <= one * power) ?? 10);
}

/** Round numbers between two. @param {number} low @param {number} high @param {number} most */
function steps(low, high, most) {
  const step = rounded((high - low) / most);
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({length: count}, (_, place) => Number(((first + place) * step).toPrecision(10)));
}

/**
 * @param {readonly (number | null)[]} values
 * @param {number} rows
 * @param {(row: number) => number} x
 * @param {(value: number) => number} y
 */
function path(values, rows, x, y) {
  let text = '';
  let pen = false;
  for (let row = 0; row < rows; row += 1) {
    const value = values[row];
    if (value === null) {
      pen = false;
      continue;
    }
    text += `${pen ? 'L' : 'M'}${x(row).toFixed(1)} ${y(value).toFixed(1)}`;
    pen = true;
  }
  return text;
}

/**
 * Slanted lines within a rectangle.
 * @param {number} left
 * @param {number} right
 * @param {number} top
 * @param {number} bottom
 */
function hatching(left, right, top, bottom) {
  let text = '';
  for (let x = left - (bottom - top); x < right; x += HATCH) {
    const [begin, end] = [Math.max(left, x), Math.min(right, x + bottom - top)];
    const [from, to] = [bottom - begin + x, bottom - end + x];
    text += `M${begin.toFixed(1)} ${from.toFixed(1)}L${end.toFixed(1)} ${to.toFixed(1)}`;
  }
  return text;
}
