// Diagonal lines where there is nothing to see yet: rows that the detector has not judged.

const PITCH = 5; // px between two lines

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
