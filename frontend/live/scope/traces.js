// Columns as curves and bands on a canvas. The code that runs most often of all.

/** @import {Source} from '../types.js' */

// A browser strokes a path in time that grows with the square of what crosses in it: a noisy curve in one piece takes
// 17 ms without a graphics card, in pieces 1 ms. Pieces share their end points and are opaque, so nobody sees where
// they meet. They begin at rows of their own, not at the edge of the window: a curve that scrolls does not shimmer.
export const PIECE = 7; // this number of bins and one more (twice as many rows where each is a point) are a piece
export const DASHED_PIECE = 63; // dashes begin anew in each piece
export const WHOLE = -1;

/**
 * Stroke a column, put together in bins of 2^power rows, in pieces (PIECE, or WHOLE). x = x0 + row·dx, y = y0 +
 * value·dy; y is kept between the limits, so that a curve that has left all bounds still ends at the edge.
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} piece
 * @param {Source} source
 * @param {number} first
 * @param {number} last
 * @param {number} power
 * @param {number} x0
 * @param {number} dx
 * @param {number} y0
 * @param {number} dy
 * @param {number} top
 * @param {number} bottom
 */
export function strokeTrace(ctx, piece, source, first, last, power, x0, dx, y0, dy, top, bottom) {
  ctx.beginPath();
  if (power === 0) strokePoints(ctx, 2 * piece + 1, source, first, last, x0, dx, y0, dy, top, bottom);
  else strokeBins(ctx, piece, source, first, last, power, x0, dx, y0, dy, top, bottom);
  ctx.stroke();
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} piece
 * @param {Source} source
 * @param {number} first
 * @param {number} last
 * @param {number} power
 * @param {number} x0
 * @param {number} dx
 * @param {number} y0
 * @param {number} dy
 * @param {number} top
 * @param {number} bottom
 */
function strokeBins(ctx, piece, {low, high, mask, pair}, first, last, power, x0, dx, y0, dy, top, bottom) {
  const each = 1 << power;
  const end = Math.floor((last - 1) / each);
  let down = false;
  let before = 0;
  for (let bin = Math.floor(first / each); bin <= end; bin += 1) {
    const i = pair ? 2 * bin : bin;
    let least = low[i & mask];
    let most = high[i & mask];
    if (pair) {
      const a = low[(i + 1) & mask];
      const b = high[(i + 1) & mask];
      if (!(least <= a) && a === a && (i + 1) * (each / 2) < last) least = a;
      if (!(most >= b) && b === b && (i + 1) * (each / 2) < last) most = b;
    }
    if (least !== least) {
      down = false;
      continue;
    }
    const x = x0 + Math.min(bin * each + each / 2, last - 1) * dx;
    const y1 = Math.min(bottom, Math.max(top, y0 + least * dy));
    const y2 = Math.min(bottom, Math.max(top, y0 + most * dy));
    if (!down) ctx.moveTo(x, (before = y1));
    if (y1 - y2 < 0.7) ctx.lineTo(x, (before = (y1 + y2) / 2));
    else if (Math.abs(before - y1) <= Math.abs(before - y2)) {
      if (down) ctx.lineTo(x, y1);
      ctx.lineTo(x, (before = y2));
    } else {
      if (down) ctx.lineTo(x, y2);
      ctx.lineTo(x, (before = y1));
    }
    down = true;
    if ((bin & piece) !== piece) continue;
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(x, before);
  }
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} piece
 * @param {Source} source
 * @param {number} first
 * @param {number} last
 * @param {number} x0
 * @param {number} dx
 * @param {number} y0
 * @param {number} dy
 * @param {number} top
 * @param {number} bottom
 */
function strokePoints(ctx, piece, {low, mask}, first, last, x0, dx, y0, dy, top, bottom) {
  let down = false;
  for (let row = Math.max(0, Math.floor(first)); row < last; row += 1) {
    const value = low[row & mask];
    if (value !== value) {
      down = false;
      continue;
    }
    const y = Math.min(bottom, Math.max(top, y0 + value * dy));
    if (down) ctx.lineTo(x0 + row * dx, y);
    else ctx.moveTo(x0 + row * dx, y);
    down = true;
    if ((row & piece) !== piece) continue;
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(x0 + row * dx, y);
  }
}

/**
 * The area between two columns (a confidence band) as one path.
 * @param {CanvasRenderingContext2D} ctx
 * @param {Source} lower
 * @param {Source} upper
 * @param {number} first
 * @param {number} last
 * @param {number} power
 * @param {number} x0
 * @param {number} dx
 * @param {number} y0
 * @param {number} dy
 * @param {number} top
 * @param {number} bottom
 */
export function bandPath(ctx, lower, upper, first, last, power, x0, dx, y0, dy, top, bottom) {
  const each = 1 << power;
  const from = Math.floor(first / each);
  const end = Math.floor((last - 1) / each);
  /** @type {number[]} */
  const back = [];
  let open = false;
  const close = () => {
    for (let i = back.length - 2; i >= 0; i -= 2) ctx.lineTo(back[i], back[i + 1]);
    if (open) ctx.closePath();
    back.length = 0;
    open = false;
  };
  for (let bin = from; bin <= end; bin += 1) {
    const i = lower.pair ? 2 * bin : bin;
    const least = lower.low[i & lower.mask];
    const most = upper.high[i & upper.mask];
    if (least !== least || most !== most) {
      close();
      continue;
    }
    const x = x0 + Math.min(bin * each + (each - 1) / 2, last - 1) * dx;
    const y = Math.min(bottom, Math.max(top, y0 + most * dy));
    if (open) ctx.lineTo(x, y);
    else ctx.moveTo(x, y);
    open = true;
    back.push(x, Math.min(bottom, Math.max(top, y0 + least * dy)));
  }
  close();
}
