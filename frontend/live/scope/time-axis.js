// The time axis under the strips.

import {marks} from './axes.js';

/** @import {Palette, Place, View} from '../types.js' */

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {Place} options
 * @param {View} view
 * @param {Palette} colours
 */
export function drawTimeAxis(ctx, {left, width, full, height}, view, colours) {
  ctx.clearRect(0, 0, full, height);
  ctx.fillStyle = colours.soft;
  ctx.font = colours.number;
  ctx.textBaseline = 'middle';
  ctx.textAlign = 'center';
  const places = Math.max(0, Math.ceil(-Math.log10(view.step) - 1e-9));
  const times = marks(view.t0, view.t1, view.step);
  for (const t of times) {
    const x = left + ((t - view.t0) / (view.t1 - view.t0)) * width;
    if (x < left - 1 || x > left + width - 8) continue;
    const words = t === 0 ? '0' : t.toFixed(places);
    ctx.fillText(t === times[times[0] === 0 ? 1 : 0] ? `${words} s` : words, x, height / 2);
  }
}
