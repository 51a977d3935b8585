// A curve drawn by hand: with the pointer, or with the arrow keys, on a small canvas. It becomes a table.

import {context, h, number} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import {Room, Signal} from './shapes.js' */

export const PLACES = 61; // points of the curve
const RIM = 4; // px

/**
 * Values with a straight line from one point to another: a pointer may skip places.
 * @param {number[]} values
 * @param {[place: number, value: number]} from
 * @param {[place: number, value: number]} to
 */
export function withLine(values, from, to) {
  const next = [...values];
  const steps = Math.max(1, Math.abs(to[0] - from[0]));
  for (let k = 0; k <= steps; k += 1) {
    const place = Math.round(from[0] + ((to[0] - from[0]) * k) / steps);
    if (place >= 0 && place < next.length) next[place] = from[1] + ((to[1] - from[1]) * k) / steps;
  }
  return next;
}

/**
 * The table of a curve that begins at a time.
 * @param {number[]} values
 * @param {number} start   s
 * @param {number} length  s
 * @returns {Signal}
 */
export const tableOf = (values, start, length) => ({
  kind: 'table',
  times: values.map((_, k) => Number((start + (k * length) / (values.length - 1)).toPrecision(12))),
  values: values.map((value) => Number(value.toPrecision(4))),
  interpolation: 'linear',
});

/**
 * A place to draw on. `done` is called at the end of a gesture, and when Enter is pressed.
 * @param {{
 *   name: string, unit: string, room: () => Room, length: () => number, level: number, done: () => void,
 * }} options
 */
export function drawing({name, unit, room, length, level, done}) {
  const canvas = h('canvas', {
    class: 'drawing',
    tabindex: 0,
    role: 'slider',
    'aria-orientation': 'vertical',
    'aria-label': t('page.inputs.draw.label', {name}),
    title: t('page.inputs.draw.keys'),
  });
  /** @type {number[]} */
  let values = Array.from({length: PLACES}, () => level);
  let place = 0;
  let off = false;
  /** @type {[number, number] | null} the point that a gesture has reached */
  let reached = null;
  const paint = () => {
    const {low, high} = room();
    const ctx = context(canvas);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const scale = devicePixelRatio || 1;
    canvas.width = Math.max(1, width * scale);
    canvas.height = Math.max(1, height * scale);
    ctx.scale(scale, scale);
    const style = getComputedStyle(canvas);
    const x = (/** @type {number} */ k) => RIM + (k / (PLACES - 1)) * (width - 2 * RIM);
    const y = (/** @type {number} */ v) => RIM + (1 - (v - low) / (high - low)) * (height - 2 * RIM);
    ctx.strokeStyle = style.color;
    ctx.lineWidth = 1.6;
    ctx.beginPath();
    for (const [k, value] of values.entries()) ctx.lineTo(x(k), y(value));
    ctx.stroke();
    if (document.activeElement === canvas) {
      ctx.fillStyle = style.accentColor === 'auto' ? style.color : style.accentColor;
      ctx.beginPath();
      ctx.arc(x(place), y(values[place]), 3.6, 0, 7);
      ctx.fill();
    }
    canvas.setAttribute('aria-valuemin', String(low));
    canvas.setAttribute('aria-valuemax', String(high));
    canvas.setAttribute('aria-valuenow', String(values[place]));
    const at = number((place / (PLACES - 1)) * length(), 3);
    canvas.setAttribute('aria-valuetext', t('page.inputs.draw.point', {t: at, value: number(values[place], 3), unit}));
  };
  /** @param {PointerEvent} event @returns {[number, number]} */
  const pointOf = (event) => {
    const {left, top, width, height} = canvas.getBoundingClientRect();
    const {low, high} = room();
    const across = (event.clientX - left - RIM) / (width - 2 * RIM);
    const up = 1 - (event.clientY - top - RIM) / (height - 2 * RIM);
    const k = Math.round(Math.min(1, Math.max(0, across)) * (PLACES - 1));
    return [k, low + Math.min(1, Math.max(0, up)) * (high - low)];
  };
  canvas.addEventListener('pointerdown', (event) => {
    if (off || event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    reached = pointOf(event);
    values = withLine(values, reached, reached);
    place = reached[0];
    paint();
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!reached) return;
    for (const one of event.getCoalescedEvents?.() ?? [event]) {
      const next = pointOf(one);
      values = withLine(values, reached, next);
      reached = next;
    }
    place = reached[0];
    paint();
  });
  const end = () => {
    if (!reached) return;
    reached = null;
    done();
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', () => {
    reached = null;
  });
  canvas.addEventListener('keydown', (event) => {
    if (off || event.ctrlKey || event.metaKey || event.altKey) return;
    const {low, high} = room();
    const by = (high - low) / (event.shiftKey ? 10 : 50);
    const value = Math.min(high, Math.max(low, values[place]));
    const far = event.shiftKey ? 10 : 1;
    /** @type {{[key: string]: () => void}} */
    const keys = {
      ArrowLeft: () => moveTo(place - far),
      ArrowRight: () => moveTo(place + far),
      Home: () => moveTo(0),
      End: () => moveTo(PLACES - 1),
      ArrowUp: () => raiseTo(Math.min(high, value + by)),
      ArrowDown: () => raiseTo(Math.max(low, value - by)),
      Enter: done,
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    event.stopPropagation(); // the page has its own arrow keys
    keys[event.key]();
    paint();
  });
  /** @param {number} next */
  const moveTo = (next) => {
    place = Math.min(PLACES - 1, Math.max(0, next));
  };
  /** This place and all after it: a level that holds is drawn with few keys. @param {number} value */
  const raiseTo = (value) => {
    values = values.map((one, k) => (k >= place ? value : one));
  };
  for (const kind of ['focus', 'blur']) canvas.addEventListener(kind, paint);
  new ResizeObserver(paint).observe(canvas);
  addEventListener('theme', paint);
  return {
    element: canvas,
    paint,
    get values() {
      return values;
    },
    /** @param {boolean} disabled */
    disable(disabled) {
      off = disabled;
      canvas.tabIndex = disabled ? -1 : 0;
      canvas.setAttribute('aria-disabled', String(disabled));
    },
  };
}
