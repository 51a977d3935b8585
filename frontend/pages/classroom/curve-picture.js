// A strip of curves on a phone or on the wall: drawn on a canvas as rows arrive, with marks on top.

import {context, fill, h, number, symbol} from '../../common/dom.js';
import {marks, niceStep} from '../../live/scope/axes.js';
import {decode} from '../../live/net/socket.js';
import {plain} from '../../common/names.js';
import {named, t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */

/**
 * @typedef {object} Mark   a vertical line
 * @property {number} t
 * @property {'ink' | 'fault' | 'alarm'} kind
 * @property {string} [text]
 */

/**
 * @typedef {object} Frame_   how the axis of time is shown, and what lies on it
 * @property {number | null} [since]
 * @property {number | null} [until]      the end of the axis; the time from now to it is unknown
 * @property {Mark[]} [marks]
 * @property {[number, number] | null} [fault]     from when to when a fault acts
 * @property {[number, number] | null} [untold]    from when to when nobody could have told
 */

const LONGEST = 120; // s that are shown where the axis follows
const LEFT = 44;
const BOTTOM = 22;

export class CurvePicture {
  /** @param {{compact?: boolean, times?: boolean}} [how]   compact: its words lie in it; times: the axis has numbers */
  constructor({compact = false, times = true} = {}) {
    this.compact = compact;
    this.top = compact ? 17 : 6;
    this.times = times;
    this.canvas = h('canvas', {class: 'curves', role: 'img'});
    this.caption = h('p', {class: 'curves-caption'});
    this.root = h('div', {class: 'curves-box', hidden: true}, !compact && this.caption, this.canvas);
    /** @type {service.CurvesHead | null} */
    this.head = null;
    /** @type {number[][]} values of each line, by row after the first */
    this.lines = [];
    /** @type {Frame_} */
    this.view = {};
    this.waiting = false;
    new ResizeObserver(() => this.soon()).observe(this.canvas);
    addEventListener('theme', () => this.soon());
  }

  /** Take a message of the stream of curves. @param {string | ArrayBuffer} data */
  receive(data) {
    if (typeof data === 'string') this.begin(JSON.parse(data));
    else this.add(decode(data));
  }

  /** @param {service.CurvesHead} head */
  begin(head) {
    this.head = head;
    this.lines = (head.strip?.lines ?? []).map(() => []);
    this.root.hidden = head.strip === null;
    this.label();
    this.soon();
  }

  label() {
    const {strip} = this.head ?? {};
    if (!strip) return;
    const of = symbol(strip.symbol);
    const words = strip.residual ? t('page.classroom.residual') : '';
    const told = [named(strip.title), words, strip.unit].filter(Boolean).join(', ');
    fill(this.caption, strip.residual ? [of, ' − ', symbol(strip.symbol, true)] : of, ' ', h('span', {}, told));
    this.canvas.setAttribute('aria-label', `${strip.symbol} ${told}`);
  }

  /** @param {{epoch: number, first: number, count: number, data: Float32Array}} frame */
  add({epoch, first, count, data}) {
    if (!this.head?.strip || epoch !== this.head.epoch) return;
    const offset = first - this.head.row;
    for (let place = 0; place < this.lines.length; place += 1)
      for (let row = 0; row < count; row += 1) this.lines[place][offset + row] = data[place * count + row];
    this.soon();
  }

  /** Time of the last row. */
  get now() {
    const rows = this.lines[0]?.length ?? 0;
    return this.head && rows ? (this.head.row + rows - 1) * this.head.record : 0;
  }

  /** @param {Frame_} view */
  show(view) {
    this.view = view;
    this.soon();
  }

  soon() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  /** The axis of time. @returns {[number, number]} */
  span() {
    const {since, until} = this.view;
    const end = this.head?.horizon ?? Math.max(until ?? 0, this.now, 1);
    const begin = this.head?.horizon ? 0 : (since ?? Math.max(0, end - LONGEST));
    return [Math.min(begin, end - 1e-9), end];
  }

  /** @param {number} t0 @param {number} t1 @returns {[number, number]} */
  range(t0, t1) {
    let low = Infinity;
    let high = -Infinity;
    const {row = 0, record = 1} = this.head ?? {};
    const first = Math.max(0, Math.floor(t0 / record) - row);
    const last = Math.ceil(t1 / record) - row + 1;
    for (const line of this.lines)
      for (let i = first; i < Math.min(last, line.length); i += 1) {
        if (line[i] < low) low = line[i];
        if (line[i] > high) high = line[i];
      }
    if (!(low <= high)) return [-1, 1];
    const room = Math.max((high - low) * 0.12, Math.abs(high + low) * 1e-3, 1e-9);
    return [low - room, high + room];
  }

  draw() {
    const {width, height} = this.canvas.getBoundingClientRect();
    if (!this.head?.strip || width < 20) return;
    const scale = devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * scale) || this.canvas.height !== Math.round(height * scale)) {
      this.canvas.width = Math.round(width * scale);
      this.canvas.height = Math.round(height * scale);
    }
    const style = getComputedStyle(this.canvas);
    /** @param {string} name */
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    const ctx = context(this.canvas);
    ctx.setTransform(scale, 0, 0, scale, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const [t0, t1] = this.span();
    const [low, high] = this.range(t0, t1);
    const right = width - 6;
    const bottom = height - (this.times ? BOTTOM : 5);
    /** @param {number} t */
    const x = (t) => LEFT + ((t - t0) / (t1 - t0)) * (right - LEFT);
    /** @param {number} v */
    const y = (v) => bottom - ((v - low) / (high - low)) * (bottom - this.top);
    this.ground(ctx, {x, right, bottom, colour});
    ctx.font = `11px ${style.getPropertyValue('--num')}`;
    ctx.fillStyle = colour('soft');
    ctx.strokeStyle = colour('line');
    ctx.lineWidth = 1;
    ctx.textAlign = 'right';
    ctx.textBaseline = 'middle';
    const step = niceStep(high - low, 3);
    for (const value of marks(low, high, step)) {
      line(ctx, LEFT, y(value), right, y(value));
      ctx.fillText(number(value, 3), LEFT - 6, y(value));
    }
    ctx.textAlign = 'center';
    ctx.textBaseline = 'top';
    const wide = niceStep(t1 - t0, Math.max(2, (right - LEFT) / 70));
    for (const value of marks(t0, t1, wide)) {
      line(ctx, x(value), this.top, x(value), bottom);
      if (this.times) ctx.fillText(number(value, 5), Math.min(x(value), right - 8), bottom + 6);
    }
    ctx.strokeRect(LEFT, this.top, right - LEFT, bottom - this.top);
    ctx.save();
    ctx.beginPath();
    ctx.rect(LEFT, this.top, right - LEFT, bottom - this.top);
    ctx.clip();
    this.lines.forEach((values, place) => this.curve(ctx, values, place, {x, y, t0, t1, colour}));
    ctx.restore();
    if (this.compact) this.inside(ctx, colour);
    for (const mark of this.view.marks ?? []) this.mark(ctx, mark, {x, bottom, right, colour});
  }

  /** @param {CanvasRenderingContext2D} ctx @param {(name: string) => string} colour */
  inside(ctx, colour) {
    ctx.font = `11px ${colour('ui')}`;
    ctx.textAlign = 'left';
    ctx.textBaseline = 'top';
    ctx.fillStyle = colour('soft');
    const {symbol: of = '', title = null, unit = ''} = this.head?.strip ?? {};
    const words = [plain(of), named(title)].filter(Boolean).join(' · ');
    ctx.fillText([words, unit].filter(Boolean).join(', '), LEFT, 1);
  }

  /**
   * @param {CanvasRenderingContext2D} ctx
   * @param {{x: (t: number) => number, right: number, bottom: number, colour: (name: string) => string}} frame
   */
  ground(ctx, {x, right, bottom, colour}) {
    const {until, fault, untold} = this.view;
    if (until && until > this.now) {
      ctx.fillStyle = colour('button');
      ctx.fillRect(x(this.now), this.top, right - x(this.now), bottom - this.top);
      ctx.fillStyle = colour('soft');
      ctx.font = `600 18px ${colour('ui')}`;
      ctx.textAlign = 'center';
      ctx.textBaseline = 'middle';
      ctx.fillText('?', (x(this.now) + right) / 2, bottom / 2);
    }
    if (fault) {
      ctx.fillStyle = colour('fault-soft');
      ctx.fillRect(x(fault[0]), this.top, Math.min(right, x(fault[1])) - x(fault[0]), bottom - this.top);
    }
    if (untold) {
      ctx.save();
      ctx.beginPath();
      ctx.rect(x(untold[0]), this.top, Math.min(right, x(untold[1])) - x(untold[0]), bottom - this.top);
      ctx.clip();
      ctx.strokeStyle = colour('fault-line');
      ctx.globalAlpha = 0.55;
      ctx.lineWidth = 1;
      for (let at = x(untold[0]) - bottom; at < right; at += 7) line(ctx, at, bottom, at + bottom, 0);
      ctx.restore();
    }
  }

  /**
   * @param {CanvasRenderingContext2D} ctx
   * @param {number[]} values
   * @param {number} place
   * @param {{x: (t: number) => number, y: (v: number) => number, t0: number, t1: number,
   *   colour: (name: string) => string}} frame
   */
  curve(ctx, values, place, {x, y, t0, t1, colour}) {
    const head = /** @type {service.CurvesHead} */ (this.head);
    const {role, place: observer = 0} = /** @type {service.CurveStrip} */ (head.strip).lines[place];
    ctx.strokeStyle =
      role === 'truth' ? colour('ink') : role === 'measured' ? colour('soft') : colour(`o${observer % 7}`);
    ctx.setLineDash(role === 'truth' ? [6, 4] : []);
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    const first = Math.max(0, Math.floor(t0 / head.record) - head.row);
    const last = Math.min(values.length, Math.ceil(t1 / head.record) - head.row + 1);
    const every = Math.max(1, Math.floor((last - first) / 1500));
    let down = false;
    for (let i = first; i < last; i += every) {
      const value = values[i];
      if (value !== value) down = false;
      else if (down) ctx.lineTo(x((head.row + i) * head.record), y(value));
      else ctx.moveTo(x((head.row + i) * head.record), y(value));
      down = value === value;
    }
    ctx.stroke();
    ctx.setLineDash([]);
  }

  /**
   * @param {CanvasRenderingContext2D} ctx
   * @param {Mark} mark
   * @param {{x: (t: number) => number, bottom: number, right: number, colour: (name: string) => string}} frame
   */
  mark(ctx, {t: at, kind, text}, {x, bottom, right, colour}) {
    const here = x(at);
    if (here < LEFT - 1 || here > right + 1) return;
    const shade = colour({ink: 'ink', fault: 'fault-line', alarm: 'alarm'}[kind]);
    ctx.strokeStyle = ctx.fillStyle = shade;
    ctx.lineWidth = kind === 'ink' ? 2 : 1.5;
    ctx.setLineDash(kind === 'alarm' ? [3, 3] : []);
    line(ctx, here, this.top, here, bottom);
    ctx.setLineDash([]);
    if (kind === 'alarm') {
      ctx.beginPath();
      ctx.moveTo(here - 6, this.top - 4);
      ctx.lineTo(here + 6, this.top - 4);
      ctx.lineTo(here, this.top + 5);
      ctx.fill();
    }
    if (!text) return;
    const flip = here > (LEFT + right) / 2;
    ctx.font = `600 11px ${colour('ui')}`;
    ctx.textAlign = flip ? 'right' : 'left';
    ctx.textBaseline = kind === 'fault' ? 'bottom' : 'top';
    ctx.fillStyle = kind === 'fault' ? colour('fault-text') : shade;
    ctx.fillText(text, here + (flip ? -7 : 7), kind === 'fault' ? bottom - 5 : this.top + (kind === 'alarm' ? 20 : 5));
  }
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1
 */
function line(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}
