// The wave of a signal: what was applied and what is coming, on both sides of a blue line that is now.

import {post} from '../../common/api.js';
import {h} from '../../common/dom.js';
import {throttled} from '../controls.js';
import {stretch} from './shapes.js';

/** @import * as service from '../../types/service.js' */
/** @import {Signal} from './shapes.js' */

/** @typedef {{t: ArrayLike<number>, v: ArrayLike<number>}} Curve */

const [WIDTH, HEIGHT, RIM] = [240, 38, 3];
const PAST = 0.62; // share of the width
const AHEAD = 3; // futures that are asked for together

/**
 * Lines through points, as the data of a path.
 * @param {Curve} curve
 * @param {(t: number) => number} x
 * @param {(v: number) => number} y
 */
export function pathOf({t, v}, x, y) {
  const parts = [];
  for (let k = 0; k < t.length; k += 1)
    if (Number.isFinite(v[k])) parts.push(`${x(t[k]).toFixed(1)} ${y(v[k]).toFixed(1)}`);
  return parts.length ? `M${parts.join('L')}` : '';
}

/**
 * The least and greatest value between two times, and the reach that shows them.
 * @param {Curve[]} curves
 * @param {number} from
 * @param {number} to
 * @returns {[number, number]}
 */
export function reach(curves, from, to) {
  let [low, high] = [Infinity, -Infinity];
  for (const {t, v} of curves)
    for (let k = 0; k < t.length; k += 1)
      if (t[k] >= from && t[k] <= to && Number.isFinite(v[k]))
        [low, high] = [Math.min(low, v[k]), Math.max(high, v[k])];
  if (!(low <= high)) return [-1, 1];
  const rim = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - rim, high + rim];
}

/**
 * The part of a curve after a time, beginning there.
 * @param {Curve} curve
 * @param {number} now
 * @returns {Curve}
 */
export function after({t, v}, now) {
  let first = 0;
  while (first < t.length && t[first] <= now) first += 1;
  const rest = {t: Array.from(t).slice(first), v: Array.from(v).slice(first)};
  if (first === 0 || first === t.length) return rest;
  const share = (now - t[first - 1]) / (t[first] - t[first - 1]);
  return {t: [now, ...rest.t], v: [v[first - 1] + share * (v[first] - v[first - 1]), ...rest.v]};
}

/**
 * The picture of a signal. `past` returns what was applied between two times.
 * @param {{name: string, past: (from: number, to: number) => Curve, horizon: () => number}} options
 */
export function wave({name, past, horizon}) {
  const line = h('path', {class: 'wave-line'});
  const ahead = h('path', {class: 'wave-line ahead'});
  const mark = h('line', {class: 'wave-now', y1: 0, y2: HEIGHT});
  const element = h(
    'svg',
    {class: 'wave', viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', role: 'img', 'aria-label': name},
    line,
    ahead,
    mark,
  );
  /** @type {Signal | null} */
  let shown = null;
  /** @type {Curve & {start: number, end: number}} */
  let coming = {t: [], v: [], start: 0, end: 0};
  let [drawn, asked] = [-1, 0];
  const ask = throttled(async (/** @type {Signal} */ signal, /** @type {number} */ now, /** @type {number} */ span) => {
    const end = now + AHEAD * span;
    try {
      /** @type {service.SignalCurve} */
      const {t, values} = await post('/api/signals/curve', {signal, start: now, end, places: 200 * AHEAD});
      if (signal === shown) coming = {t, v: values, start: now, end};
    } catch {
      if (signal === shown) coming = {t: [], v: [], start: now, end}; // the past is shown; the session refuses errors
    }
    drawn = -1;
    draw(now);
  }, 250);
  /** @param {number} now */
  const draw = (now) => {
    const whole = shown ? stretch(shown, horizon()) : 0.3 * horizon();
    const [from, to] = [now - PAST * whole, now + (1 - PAST) * whole];
    if (shown && whole > 0 && (to > coming.end || now < coming.start) && asked !== coming.end) {
      asked = coming.end;
      ask(shown, now, (1 - PAST) * whole);
    }
    if (drawn === now || !(whole > 0)) return;
    drawn = now;
    const before = past(Math.max(0, from), now);
    const [low, high] = reach([before, coming], from, to);
    /** @param {number} t */
    const x = (t) => Math.min(1.5 * WIDTH, ((t - from) / whole) * WIDTH);
    /** @param {number} v */
    const y = (v) => RIM + (1 - (v - low) / (high - low)) * (HEIGHT - 2 * RIM);
    line.setAttribute('d', pathOf(before, x, y));
    ahead.setAttribute('d', pathOf(after(coming, now), x, y));
    for (const end of ['x1', 'x2']) mark.setAttribute(end, String(PAST * WIDTH));
  };
  return {
    element,
    draw,
    /**
     * Show another signal from now on; null: what is coming is not known.
     * @param {Signal | null} signal
     * @param {number} now
     */
    show(signal, now) {
      if (JSON.stringify(signal) !== JSON.stringify(shown)) {
        shown = signal;
        coming = signal ? {...coming, end: -1} : {t: [], v: [], start: 0, end: 0};
        asked = 0;
      }
      drawn = -1;
      draw(now);
    },
  };
}
