// Drawing one strip on its canvas. Everything is in CSS pixels; the caller has set the scale. The only code that runs
// 30 to 60 times a second.

import {marks} from './axes.js';
import {hatch, hatchPending} from './hatch.js';
import {drawSketch} from './sketch.js';
import {bandPath, DASHED_PIECE, PIECE, strokeTrace, WHOLE} from './traces.js';
import {COLOURS, DASH_DOT} from '../../widgets/line-style.js';

/** @import {DrawnStrip, Palette, Place, Range, Samples, Scale, View} from '../types.js' */

const SLIVER = 3; // px
const FILLED = 2; // bands; more of them are paler

/** Colours and fonts as the style sheet has them, read once a theme. */
export function palette() {
  const style = getComputedStyle(document.documentElement);
  /** @param {string} name */
  const read = (name) => style.getPropertyValue(name).trim();
  const size = parseFloat(style.fontSize) / 13.5;
  return {
    ink: read('--ink'),
    soft: read('--soft'),
    line: read('--line'),
    grid: read('--grid'),
    card: read('--card'),
    tint: read('--fault-soft'),
    fault: read('--fault-line'),
    amber: read('--fault'),
    accent: read('--accent'),
    alarm: read('--alarm'),
    ok: read('--ok'),
    observers: Array.from({length: COLOURS}, (_, place) => read(`--o${place}`)),
    number: `${10.5 * size}px ${read('--num')}`,
    words: `${13 * size}px ${read('--ui')}`,
    size,
  };
}

/**
 * Draw a strip.
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {Place} place
 * @param {View} view
 * @param {Range} range
 * @param {Palette} colours
 */
export function drawStrip(ctx, strip, place, view, range, colours) {
  const {left, width, height} = place;
  ctx.clearRect(0, 0, place.full, height);
  /** @type {Scale} */
  const scale = {
    x: (t) => left + ((t - view.t0) / (view.t1 - view.t0)) * width,
    y: (value) => height - ((value - range.low) / (range.high - range.low)) * height,
  };
  drawGround(ctx, strip, place, view, range, scale, colours);
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, 0, width, height);
  ctx.clip();
  ctx.lineJoin = 'bevel'; // at this width nobody can tell it from round, which takes twice as long
  if (view.ghost) drawTraces(ctx, strip, place, {...view, samples: view.ghost}, range, colours, true);
  drawTraces(ctx, strip, place, view, range, colours, false);
  drawMarks(ctx, strip, place, view, scale, colours);
  if (view.judged !== null && (strip.kind === 'theta' || strip.kind === 'residual'))
    hatch(
      ctx,
      {
        left: Math.max(left, scale.x(view.judged)),
        right: Math.min(left + width, scale.x(view.now)),
        top: 0,
        bottom: height,
      },
      colours.soft,
    );
  hatchPending(ctx, place, view, scale, colours);
  if (strip.sketch) drawSketch(ctx, strip.sketch, scale, colours);
  ctx.restore();
  ctx.strokeStyle = colours.line;
  ctx.lineWidth = 1;
  ctx.strokeRect(left + 0.5, 0.5, width - 1, height - 1);
}

/**
 * The times at which a fault acts, each once however many act together; one injected while time is paused shows as a
 * sliver at the edge.
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {{left: number, right: number, height: number}} options
 * @param {View} view
 * @param {Scale} scale
 * @param {Palette} colours
 */
function drawTint(ctx, strip, {left, right, height}, view, scale, colours) {
  if (strip.kind !== 'theta' && strip.kind !== 'residual') return;
  ctx.fillStyle = colours.tint;
  ctx.beginPath();
  for (const fault of view.faults) {
    if (
      fault.subject !== strip.subject ||
      fault.onChannel !== (strip.kind === 'theta') ||
      fault.onset > view.t1 + view.row
    )
      continue;
    const edge = scale.x(Math.min(view.now, view.t1));
    const from = Math.max(left, fault.active ? Math.min(scale.x(fault.onset), edge - SLIVER) : scale.x(fault.onset));
    const to = Math.min(right, scale.x(Math.min(fault.end ?? Infinity, view.now)));
    if (to > from) ctx.rect(from, 0, to - from, height);
  }
  ctx.fill();
}

/**
 * Grid, zero line, threshold, marks of the vertical axis.
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {Place} options
 * @param {View} view
 * @param {Range} range
 * @param {Scale} scale
 * @param {Palette} colours
 */
function drawGround(ctx, strip, {left, width, height}, view, range, scale, colours) {
  const right = left + width;
  drawTint(ctx, strip, {left, right, height}, view, scale, colours);
  ctx.strokeStyle = colours.grid;
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (const t of marks(view.t0, view.t1, view.step)) {
    const x = Math.round(scale.x(t)) + 0.5;
    ctx.moveTo(x, 0);
    ctx.lineTo(x, height);
  }
  ctx.stroke();
  ctx.fillStyle = colours.soft;
  ctx.font = colours.number;
  ctx.textAlign = 'right';
  ctx.textBaseline = 'middle';
  const half = 5 * colours.size; // at an edge the number moves inside
  if (strip.power) ctx.fillText(strip.power, left - 6, half);
  strip.ticks.forEach((value, i) => {
    const y = scale.y(value);
    if (y < (strip.power ? 3 * half : 1) || y > height - 1) return;
    ctx.fillText(strip.labels[i], left - 6, Math.min(height - half, Math.max(half, y)));
    if (value !== 0 || strip.log) ctx.fillRect(left - 3, Math.round(y), 3, 1);
  });
  ctx.strokeStyle = colours.line;
  if (!strip.log && range.low < 0 && range.high > 0) line(ctx, left, right, Math.round(scale.y(0)) + 0.5);
  const levels = strip.line ? [strip.line, -strip.line] : strip.threshold === null ? [] : [strip.threshold];
  if (!levels.length) return;
  ctx.strokeStyle = colours.alarm;
  ctx.setLineDash([3, 4]);
  for (const level of levels) line(ctx, left, right, scale.y(level));
  ctx.setLineDash([]);
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} from
 * @param {number} to
 * @param {number} y
 */
function line(ctx, from, to, y) {
  ctx.beginPath();
  ctx.moveTo(from, y);
  ctx.lineTo(to, y);
  ctx.stroke();
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {Place} options
 * @param {View} view
 * @param {Range} range
 * @param {Palette} colours
 * @param {boolean} faint
 */
function drawTraces(ctx, strip, {left, width, height}, view, range, colours, faint) {
  const {samples} = view;
  const dx = (samples.record / (view.t1 - view.t0)) * width;
  const x0 = left - (view.t0 / samples.record) * dx;
  const dy = -height / (range.high - range.low);
  const y0 = height - range.low * dy;
  const first = Math.max(0, Math.floor(view.t0 / samples.record) - 1);
  const last = Math.min(samples.rows, Math.ceil(view.t1 / samples.record) + 2);
  if (last <= first) return;
  const power = samples.power(first, last, ((last - first) * dx) / 1.25);
  /** @type {[number, number]} how far beyond the strip curves are drawn */
  const limits = [-40, height + 40];
  /** @param {string} column @param {number} piece */
  const draw = (column, piece) => {
    const source = samples.source(column, power);
    if (source) strokeTrace(ctx, piece, source, first, last, power, x0, dx, y0, dy, ...limits);
  };
  if (!faint && view.bands)
    drawBands(ctx, strip, view, samples, [first, last, power, x0, dx, y0, dy, ...limits], colours);
  ctx.globalAlpha = faint ? 0.38 : 1;
  ctx.lineWidth = (faint ? 1 : 1.35) * colours.size;
  for (let i = strip.traces.length - 1; i >= 0; i -= 1) {
    // the first observer on top
    ctx.strokeStyle =
      strip.log && strip.traces.length === 1 ? colours.ok : colours.observers[strip.traces[i].place % COLOURS];
    const {column, dashed} = strip.traces[i];
    if (dashed) ctx.setLineDash(DASH_DOT.map((length) => length * colours.size));
    // Where pieces of a faint curve meet it would be less faint.
    draw(column, faint ? WHOLE : dashed ? DASHED_PIECE : PIECE);
    if (dashed) ctx.setLineDash([]);
  }
  if (strip.reading) {
    ctx.strokeStyle = colours.soft;
    draw(strip.reading.column, faint ? WHOLE : PIECE);
  }
  if (strip.truth) {
    ctx.strokeStyle = colours.ink;
    ctx.lineWidth = 1.2 * colours.size;
    ctx.setLineDash(faint ? [2, 4] : [5, 3]);
    ctx.lineDashOffset = first * dx; // dashes stay with the time they are at, instead of creeping along
    draw(strip.truth, WHOLE); // dashes go on through the whole of it
    ctx.setLineDash([]);
  }
  ctx.globalAlpha = 1;
}

/**
 * @typedef {[first: number, last: number, power: number, x0: number, dx: number, y0: number, dy: number,
 *   top: number, bottom: number]} Geometry
 */

/**
 * Confidence bands, the first observer's on top; many of them are paler. (Outlines would cost the square of what
 * crosses in them.)
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {View} view
 * @param {Samples} samples
 * @param {Geometry} geometry
 * @param {Palette} colours
 */
function drawBands(ctx, strip, view, samples, geometry, colours) {
  const shown = strip.traces.filter((trace) => trace.low && view.bands.has(trace.label)).reverse();
  for (const trace of shown) {
    if (trace.low === undefined || trace.high === undefined) continue;
    const lower = samples.source(trace.low, geometry[2]);
    const upper = samples.source(trace.high, geometry[2]);
    if (!lower || !upper) continue;
    ctx.fillStyle = colours.observers[trace.place % COLOURS];
    ctx.globalAlpha = shown.length > FILLED ? 0.11 : 0.16;
    ctx.beginPath();
    bandPath(ctx, lower, upper, ...geometry);
    ctx.fill();
    ctx.globalAlpha = 1;
  }
}

/**
 * Where faults begin and end, on all strips; where curves end; alarms.
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {Place} options
 * @param {View} view
 * @param {Scale} scale
 * @param {Palette} colours
 */
function drawMarks(ctx, strip, {left, width, height}, view, scale, colours) {
  const right = left + width;
  ctx.strokeStyle = colours.fault;
  for (const fault of view.faults) {
    const own = fault.subject === strip.subject && strip.kind === 'theta';
    ctx.globalAlpha = own ? 0.9 : 0.4;
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (const t of [fault.onset, fault.end]) {
      if (t === null || t < view.t0 || t > Math.min(view.t1, view.now) + 1.01 * view.row) continue;
      const x = Math.round(Math.min(scale.x(t), right - 2)) + 0.5;
      ctx.moveTo(x, 0);
      ctx.lineTo(x, height);
    }
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
  drawLeaving(ctx, strip, {left, right, height}, scale, colours);
  for (const {fallen, place} of strip.traces)
    if (fallen !== null && fallen >= view.t0 && fallen <= view.t1) cross(ctx, scale.x(fallen), colours, place);
  drawAlarms(ctx, strip, {left, right, height}, view, scale, colours);
}

/**
 * Arrows at the edge where a curve is beyond the axis, in its colour.
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {{left: number, right: number, height: number}} options
 * @param {Scale} scale
 * @param {Palette} colours
 */
function drawLeaving(ctx, strip, {left, right, height}, scale, colours) {
  const arm = 3.6 * colours.size;
  for (const {from, to, up, place, trace} of strip.leaving ?? []) {
    // beside those of other curves
    const x = scale.x((from + to) / 2) + (trace - (strip.traces.length - 1) / 2) * 2 * arm;
    if (x < left || x > right) continue;
    const [tip, foot] = up ? [1, 1 + 1.5 * arm] : [height - 1, height - 1 - 1.5 * arm];
    ctx.fillStyle = colours.observers[place % COLOURS];
    ctx.strokeStyle = colours.card;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(x, tip);
    ctx.lineTo(x + arm, foot);
    ctx.lineTo(x - arm, foot);
    ctx.closePath();
    ctx.stroke();
    ctx.fill();
  }
}

/**
 * Alarms on the strip that they name: a flag where it was raised, a line above for as long as it is on, and at the
 * foot when the fault began.
 * @param {CanvasRenderingContext2D} ctx
 * @param {DrawnStrip} strip
 * @param {{left: number, right: number, height: number}} options
 * @param {View} view
 * @param {Scale} scale
 * @param {Palette} colours
 */
function drawAlarms(ctx, strip, {left, right, height}, view, scale, colours) {
  if (strip.kind !== 'theta' && strip.kind !== 'residual') return;
  const size = 5 * colours.size;
  for (const alarm of view.alarms) {
    const named =
      strip.kind === 'theta'
        ? alarm.subjects.includes(strip.subject)
        : !alarm.explained && alarm.subject === strip.subject;
    const end = Math.min(alarm.over ?? Infinity, view.now);
    if (!named || alarm.from > view.t1 || end < view.t0) continue;
    const second = alarm.subject !== strip.subject; // it would explain the data equally well
    ctx.fillStyle = ctx.strokeStyle = colours.alarm;
    ctx.lineWidth = 1.2 * colours.size;
    const x = scale.x(alarm.t);
    const from = Math.max(left, x);
    ctx.globalAlpha = second ? 0.35 : 0.6;
    ctx.fillRect(from, 0, Math.max(0, Math.min(right, scale.x(end)) - from), 2 * colours.size);
    const foot = scale.x(alarm.from);
    ctx.globalAlpha = second ? 0.25 : 0.5;
    ctx.fillRect(foot, height - size, Math.max(3, scale.x(alarm.to) - foot), size);
    ctx.globalAlpha = 1;
    ctx.beginPath();
    ctx.moveTo(x - size, 0.5);
    ctx.lineTo(x + size, 0.5);
    ctx.lineTo(x, size * 1.6);
    ctx.closePath();
    if (second) {
      ctx.fillStyle = colours.card;
      ctx.fill();
      ctx.stroke();
    } else ctx.fill();
  }
}

/**
 * Where an observer's curve ends because it diverged.
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} x
 * @param {Palette} colours
 * @param {number} place
 */
function cross(ctx, x, colours, place) {
  const arm = 4 * colours.size;
  const y = 3 + arm;
  ctx.strokeStyle = colours.observers[place % COLOURS];
  ctx.lineWidth = 2 * colours.size;
  ctx.beginPath();
  ctx.moveTo(x - arm, y - arm);
  ctx.lineTo(x + arm, y + arm);
  ctx.moveTo(x - arm, y + arm);
  ctx.lineTo(x + arm, y - arm);
  ctx.stroke();
}
