// Drawing one strip on its canvas. Everything is in CSS pixels; the caller has set the scale. The only code that runs 30 to 60 times a second.

import {fixed, raised} from './format.js';
import {marks} from './axes.js';

/** Colours and fonts as the style sheet has them, read once a theme. */
export function palette() {
  const style = getComputedStyle(document.documentElement);
  const read = (name) => style.getPropertyValue(name).trim();
  const size = parseFloat(style.fontSize) / 13.5;
  return {
    ink: read('--ink'), soft: read('--soft'), line: read('--line'), grid: read('--grid'), card: read('--card'), tint: read('--fault-soft'),
    fault: read('--fault-line'), alarm: read('--alarm'), ok: read('--ok'), observers: [0, 1, 2, 3, 4, 5].map((place) => read(`--o${place}`)),
    number: `${10.5 * size}px ${read('--num')}`, size,
  };
}

/**
 * A column as a path on the canvas, put together in bins of 2^power rows. x = x0 + row·dx, y = y0 + value·dy; y is kept between the limits, so that
 * a curve that has left all bounds still ends at the edge.
 */
export function tracePath(ctx, source, first, last, power, x0, dx, y0, dy, top, bottom) {
  if (power === 0) return pointPath(ctx, source, first, last, x0, dx, y0, dy, top, bottom);
  const {low, high, mask, pair} = source;
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
    if (!down) ctx.moveTo(x, before = y1);
    if (y1 - y2 < 0.7) ctx.lineTo(x, before = (y1 + y2) / 2);
    else if (Math.abs(before - y1) <= Math.abs(before - y2)) {
      if (down) ctx.lineTo(x, y1);
      ctx.lineTo(x, before = y2);
    } else {
      if (down) ctx.lineTo(x, y2);
      ctx.lineTo(x, before = y1);
    }
    down = true;
  }
  return down;
}

function pointPath(ctx, {low, mask}, first, last, x0, dx, y0, dy, top, bottom) {
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
  }
  return down;
}

/** The area between two columns (a confidence band) as one path. */
function bandPath(ctx, lower, upper, first, last, power, x0, dx, y0, dy, top, bottom) {
  const each = 1 << power;
  const from = Math.floor(first / each);
  const end = Math.floor((last - 1) / each);
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

/**
 * Draw a strip.
 * @param {CanvasRenderingContext2D} ctx
 * @param {object} strip      as strips.js makes it
 * @param {object} place      {left, width, height} of the plot area within the canvas, {full} width of the canvas
 * @param {object} view       {t0, t1, step} of the time axis; {samples, ghost, row0} of the data; marks: {faults, alarms}
 * @param {import('./axes.js').Range} range
 * @param {object} colours    palette()
 */
export function drawStrip(ctx, strip, place, view, range, colours) {
  const {left, width, height} = place;
  ctx.clearRect(0, 0, place.full, height);
  const scale = {
    x: (t) => left + ((t - view.t0) / (view.t1 - view.t0)) * width,
    y: (value) => height - ((value - range.low) / (range.high - range.low)) * height,
  };
  drawGround(ctx, strip, place, view, range, scale, colours);
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, 0, width, height);
  ctx.clip();
  ctx.lineJoin = 'round';
  if (view.ghost) drawTraces(ctx, strip, place, {...view, samples: view.ghost}, range, colours, true);
  drawTraces(ctx, strip, place, view, range, colours, false);
  drawMarks(ctx, strip, place, view, scale, colours);
  ctx.restore();
  ctx.strokeStyle = colours.line;
  ctx.lineWidth = 1;
  ctx.strokeRect(left + 0.5, 0.5, width - 1, height - 1);
}

/** Tint of active faults, grid, zero line, threshold, marks of the vertical axis. */
function drawGround(ctx, strip, {left, width, height}, view, range, scale, colours) {
  const right = left + width;
  ctx.fillStyle = colours.tint;
  for (const fault of view.faults) {
    if (fault.subject !== strip.subject || fault.onset > view.t1 || !(strip.kind === 'theta' || (!fault.onChannel && strip.kind === 'residual'))) continue;
    const from = Math.max(left, scale.x(fault.onset));
    const to = Math.min(right, scale.x(Math.min(fault.end ?? Infinity, view.now)));
    if (to > from) ctx.fillRect(from, 0, to - from, height);
  }
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
  for (const value of strip.ticks) {
    const y = scale.y(value);
    if (y < 6 * colours.size || y > height - 6 * colours.size) continue;
    ctx.fillText(strip.log ? `10${raised(Math.round(value))}` : value === 0 ? '0' : fixed(value, strip.tickPlaces), left - 6, y);
    if (value === 0 && !strip.log) continue;
    ctx.fillRect(left - 3, Math.round(y), 3, 1);
  }
  ctx.strokeStyle = colours.line;
  if (!strip.log && range.low < 0 && range.high > 0) line(ctx, left, right, Math.round(scale.y(0)) + 0.5);
  if (strip.threshold === null) return;
  ctx.strokeStyle = colours.alarm;
  ctx.setLineDash([3, 4]);
  line(ctx, left, right, scale.y(strip.threshold));
  ctx.setLineDash([]);
}

function line(ctx, from, to, y) {
  ctx.beginPath();
  ctx.moveTo(from, y);
  ctx.lineTo(to, y);
  ctx.stroke();
}

function drawTraces(ctx, strip, {left, width, height}, view, range, colours, faint) {
  const {samples} = view;
  const dx = ((samples.record / (view.t1 - view.t0)) * width);
  const x0 = left - (view.t0 / samples.record) * dx;
  const dy = -height / (range.high - range.low);
  const y0 = height - range.low * dy;
  const first = Math.max(0, Math.floor(view.t0 / samples.record) - 1);
  const last = Math.min(samples.rows, Math.ceil(view.t1 / samples.record) + 2);
  if (last <= first) return;
  const power = samples.power(first, last, (last - first) * dx / 1.25);
  const limits = [-40, height + 40];
  const draw = (column) => {
    const source = samples.source(column, power);
    if (!source) return;
    ctx.beginPath();
    tracePath(ctx, source, first, last, power, x0, dx, y0, dy, ...limits);
    ctx.stroke();
  };
  if (!faint && view.bands) drawBands(ctx, strip, view, samples, [first, last, power, x0, dx, y0, dy, ...limits], colours);
  ctx.globalAlpha = faint ? 0.38 : 1;
  ctx.lineWidth = (faint ? 1 : 1.35) * colours.size;
  for (let i = strip.traces.length - 1; i >= 0; i -= 1) { // the first observer on top
    ctx.strokeStyle = strip.log && strip.traces.length === 1 ? colours.ok : colours.observers[strip.traces[i].place % 6];
    draw(strip.traces[i].column);
  }
  if (strip.truth) {
    ctx.strokeStyle = colours.ink;
    ctx.lineWidth = 1.2 * colours.size;
    ctx.setLineDash(faint ? [2, 4] : [5, 3]);
    ctx.lineDashOffset = first * dx; // dashes stay with the time they are at, instead of creeping along
    draw(strip.truth);
    ctx.setLineDash([]);
  }
  ctx.globalAlpha = 1;
}

function drawBands(ctx, strip, view, samples, geometry, colours) {
  for (const trace of strip.traces) {
    if (!trace.low || !view.bands.has(trace.label)) continue;
    const lower = samples.source(trace.low, geometry[2]);
    const upper = samples.source(trace.high, geometry[2]);
    if (!lower || !upper) continue;
    ctx.fillStyle = colours.observers[trace.place % 6];
    ctx.globalAlpha = 0.16;
    ctx.beginPath();
    bandPath(ctx, lower, upper, ...geometry);
    ctx.fill();
    ctx.globalAlpha = 1;
  }
}

/** Where faults begin and end (on all strips), and alarms (on the strip that they accuse). */
function drawMarks(ctx, strip, {height}, view, scale, colours) {
  ctx.strokeStyle = colours.fault;
  for (const fault of view.faults) {
    const own = fault.subject === strip.subject && strip.kind === 'theta';
    ctx.globalAlpha = own ? 0.9 : 0.4;
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (const t of [fault.onset, fault.end]) {
      if (t === null || t < view.t0 || t > Math.min(view.t1, view.now)) continue;
      const x = Math.round(scale.x(t)) + 0.5;
      ctx.moveTo(x, 0);
      ctx.lineTo(x, height);
    }
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
  for (const {fallen, place} of strip.traces) if (fallen !== null && fallen >= view.t0 && fallen <= view.t1) cross(ctx, scale.x(fallen), colours, place);
  ctx.fillStyle = colours.alarm;
  const size = 5 * colours.size;
  for (const alarm of view.alarms) {
    if (alarm.subject !== strip.subject || strip.kind !== 'theta' || alarm.t < view.t0 || alarm.t > view.t1) continue;
    const x = scale.x(alarm.t);
    ctx.beginPath();
    ctx.moveTo(x - size, 0);
    ctx.lineTo(x + size, 0);
    ctx.lineTo(x, size * 1.6);
    ctx.fill();
  }
}

/** Where an observer's curve ends because it diverged. */
function cross(ctx, x, colours, place) {
  const arm = 4 * colours.size;
  const y = 3 + arm;
  ctx.strokeStyle = colours.observers[place % 6];
  ctx.lineWidth = 2 * colours.size;
  ctx.beginPath();
  ctx.moveTo(x - arm, y - arm);
  ctx.lineTo(x + arm, y + arm);
  ctx.moveTo(x - arm, y + arm);
  ctx.lineTo(x + arm, y - arm);
  ctx.stroke();
}

/** The time axis under the strips. */
export function drawTimeAxis(ctx, {left, width, full, height}, view, colours) {
  ctx.clearRect(0, 0, full, height);
  ctx.fillStyle = colours.soft;
  ctx.font = colours.number;
  ctx.textBaseline = 'middle';
  ctx.textAlign = 'center';
  const places = Math.max(0, Math.ceil(-Math.log10(view.step) - 1e-9));
  const found = marks(view.t0, view.t1, view.step);
  for (const t of found) {
    const x = left + ((t - view.t0) / (view.t1 - view.t0)) * width;
    if (x < left - 1 || x > left + width - 8) continue;
    const words = t === 0 ? '0' : t.toFixed(places);
    ctx.fillText(t === found[found[0] === 0 ? 1 : 0] ? `${words} s` : words, x, height / 2);
  }
}
