// Diagonal lines where there is nothing to see yet: rows that the detector has not judged, time that a step has yet to
// run.

const PITCH = 5; // px between two lines

/** @import {Palette, Place, Scale, View} from '../types.js' */

/**
 * Hatch a rectangle. The lines keep their places while its edges move.
 * @param {CanvasRenderingContext2D} ctx
 * @param {{left: number, right: number, top: number, bottom: number}} box
 * @param {string} colour
 */
export function hatch(ctx, {left, right, top, bottom}, colour) {
  if (right - left < 1) return;
  const height = bottom - top;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, right - left, height);
  ctx.clip();
  ctx.strokeStyle = colour;
  ctx.globalAlpha = 0.45;
  ctx.lineWidth = 1;
  ctx.setLineDash([]);
  ctx.beginPath();
  for (let x = Math.floor((left - height) / PITCH) * PITCH; x < right; x += PITCH) {
    ctx.moveTo(x, bottom);
    ctx.lineTo(x + height, top);
  }
  ctx.stroke();
  ctx.restore();
}

/**
 * Hatch the time that a step of a lesson has yet to run, with words in its middle where they fit.
 * @param {CanvasRenderingContext2D} ctx
 * @param {Place} place
 * @param {View} view
 * @param {Scale} scale
 * @param {Palette} colours
 */
export function hatchPending(ctx, {left, width, height}, {now, pending}, scale, colours) {
  if (!pending) return;
  const from = Math.max(left, scale.x(now));
  const to = Math.min(left + width, scale.x(pending.until));
  hatch(ctx, {left: from, right: to, top: 0, bottom: height}, colours.soft);
  if (!pending.words) return;
  ctx.font = colours.words;
  const wide = ctx.measureText(pending.words).width + 20 * colours.size;
  const high = 24 * colours.size;
  if (wide > to - from || high > height) return;
  const [x, y] = [(from + to) / 2, height / 2];
  ctx.fillStyle = colours.card;
  ctx.beginPath();
  ctx.roundRect(x - wide / 2, y - high / 2, wide, high, 6);
  ctx.fill();
  ctx.fillStyle = colours.soft;
  ctx.textAlign = 'center';
  ctx.textBaseline = 'middle';
  ctx.fillText(pending.words, x, y);
}
