// What a student has drawn on a strip: a dotted line, with handles while it can still be bent.

/** @import {Palette, Scale, Sketched} from '../types.js' */

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {Sketched} sketch
 * @param {Scale} scale
 * @param {Palette} colours
 */
export function drawSketch(ctx, {values, from, until, at}, scale, colours) {
  const {size} = colours;
  const points = values.map((value, place) => [
    scale.x(from + (place / (values.length - 1)) * (until - from)),
    scale.y(value),
  ]);
  ctx.strokeStyle = colours.ink;
  ctx.lineWidth = 2 * size;
  ctx.lineCap = 'round';
  ctx.setLineDash([0.1, 4.5 * size]);
  ctx.beginPath();
  for (const [x, y] of points) ctx.lineTo(x, y);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.lineCap = 'butt';
  if (at === null) return;
  points.forEach(([x, y], place) => {
    ctx.beginPath();
    ctx.arc(x, y, (place === at ? 5.5 : 3.5) * size, 0, 2 * Math.PI);
    ctx.fillStyle = place === at ? colours.ink : colours.card;
    ctx.lineWidth = 1.4 * size;
    ctx.fill();
    ctx.stroke();
  });
}
