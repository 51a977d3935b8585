// The hysteresis of a sandwich plant: the loop v over x, and every backlash operator as a slot that its input pushes
// along.

import {COLOURS} from '../../widgets/line-style.js';
import {context, fill, h, symbol} from '../../common/dom.js';
import {Range, marks, niceStep} from './axes.js';
import {palette} from './canvas.js';
import {fixed} from '../../widgets/number-format.js';
import {moment} from './values.js';
import {t} from '../../i18n/words.js';

/** @import {App, ObserverState, Palette, Samples} from '../types.js' */
/** @import {Plant} from '../../pages/types.js' */

/**
 * A backlash operator: the state that keeps its output, and the widths of its gap.
 * @typedef {{name: string, memory: string, right: number, left: number}} Operator
 * @typedef {{input: string, operators: Operator[]}} Hysteresis
 * @typedef {{x: number[], y: number[]}} Points
 */

/**
 * The picture with its canvases.
 * @typedef {object} Picture
 * @property {App} app
 * @property {HTMLCanvasElement} loop
 * @property {HTMLCanvasElement} slots
 * @property {CanvasRenderingContext2D} ctx
 * @property {CanvasRenderingContext2D} slotCtx
 * @property {Range} x
 * @property {Range} y
 * @property {Palette} colours
 * @property {Hysteresis | null} found
 * @property {ObserverState | null} observer   the one that estimates it
 * @property {number} at
 * @property {string} still
 */

const SHOWN = 240; // rows of the loop
const BACKLASH =
  /^\s*backlash\(\s*([\p{L}\p{M}\p{N}_]+)\s*,.*,\s*([\p{L}\p{M}\p{N}_.]+)\s*,\s*([\p{L}\p{M}\p{N}_.]+)\s*\)\s*$/u;

/**
 * The backlash operators of a plant: {input, operators: [{name, memory, right, left}]}, or null without any.
 * @param {Plant | null} plant
 * @returns {Hysteresis | null}
 */
export function operatorsOf(plant) {
  const values = Object.fromEntries((plant?.parameters ?? []).map(({name, value}) => [name, value]));
  /** @param {string} text */
  const amount = (text) => (text in values ? values[text] : Number(text));
  /** @type {Operator[]} */
  const operators = [];
  /** @type {string | null} */
  let input = null;
  for (const {name, expression} of plant?.definitions ?? []) {
    const match = BACKLASH.exec(expression);
    if (!match) continue;
    input ??= match[1];
    // the state that keeps its output
    const memory = Object.entries(plant?.dynamics ?? {}).find(([, dynamics]) => dynamics.trim() === name)?.[0];
    if (memory && input === match[1]) operators.push({name, memory, right: amount(match[2]), left: amount(match[3])});
  }
  return input !== null && operators.length ? {input, operators} : null;
}

/** @param {HTMLElement} root @param {App} app */
export function mountHysteresis(root, app) {
  const loop = h('canvas', {role: 'img'});
  const slots = h('canvas', {role: 'img'});
  const values = h('span', {class: 'num'});
  /** @type {Picture} */
  const picture = {
    app,
    loop,
    slots,
    ctx: context(loop),
    slotCtx: context(slots),
    x: new Range(),
    y: new Range(),
    colours: palette(),
    found: null,
    observer: null,
    at: 0,
    still: '',
  };
  app.subscribe(
    (state) => [state.plant, state.language, state.columns],
    () => {
      const {state} = app;
      picture.found = operatorsOf(state.plant);
      root.hidden = picture.found === null;
      if (!picture.found) return;
      picture.observer =
        state.observers.find(
          ({label}) => state.columns.includes(`${label}.v`) && state.columns.includes(`${label}.zone.1`),
        ) ?? null;
      loop.setAttribute('aria-label', t('page.hysteresis.title'));
      slots.setAttribute('aria-label', t('page.hysteresis.zones'));
      fill(
        root,
        h('h2', {}, t('page.hysteresis.title'), values),
        h(
          'div',
          {class: 'loop'},
          h(
            'figure',
            {},
            loop,
            h('figcaption', {}, h('i', {}, 'v'), ` ${t('page.hysteresis.over')} `, symbol(picture.found.input)),
          ),
          h('figure', {}, slots, h('figcaption', {}, t('page.hysteresis.slots'))),
        ),
      );
      measure(picture);
    },
  );
  app.subscribe(
    (state) => [state.theme, state.presentation],
    () => {
      picture.colours = palette();
      measure(picture);
    },
  );
  new ResizeObserver(() => measure(picture)).observe(root);
  app.onFrame((now) => draw(picture, now));
  app.onTick(() => {
    if (picture.found) values.textContent = zoneWords(picture);
  });
}

/** @param {Picture} picture */
function measure(picture) {
  const ratio = Math.min(3, devicePixelRatio || 1);
  for (const {canvas, ctx} of [
    {canvas: picture.loop, ctx: picture.ctx},
    {canvas: picture.slots, ctx: picture.slotCtx},
  ]) {
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  }
  picture.still = '';
  picture.app.wake();
}

/**
 * Zone of each operator in words: how many rise, fall, remember.
 * @param {Picture} picture
 */
function zoneWords({app, found, observer}) {
  if (!observer || !found) return '';
  const zones = found.operators.map((_, i) => app.latest(`${observer.label}.zone.${i + 1}`));
  /** @param {number} zone */
  const count = (zone) => zones.filter((one) => one === zone).length;
  return [
    {zone: 1, word: t('page.hysteresis.zone.rising')},
    {zone: -1, word: t('page.hysteresis.zone.falling')},
    {zone: 0, word: t('page.hysteresis.zone.memory')},
  ]
    .map(({zone, word}) => `${word} ${count(zone)}`)
    .join(' · ');
}

/** @param {Picture} picture @param {number} now */
function draw(picture, now) {
  const {app, found} = picture;
  if (!found || picture.loop.clientWidth === 0) return false;
  const t = moment(app.state, app.samples.now);
  const shown = `${app.samples.version} ${t}`;
  const moving = [picture.x, picture.y].map((range) => range.move(now)).includes(true);
  if (shown === picture.still && !moving) return false;
  picture.still = shown;
  const end = Math.min(app.samples.rows - 1, Math.round(t / app.samples.record));
  const true_ = trueLoop(app.samples, found, end);
  const own = picture.observer ? estimated(app.samples, found, picture.observer.label, end) : null;
  if (true_.x.length > 1 && now - picture.at > 300) {
    picture.at = now;
    picture.x.aim(Math.min(...true_.x), Math.max(...true_.x), now);
    picture.y.aim(Math.min(...true_.y), Math.max(...true_.y), now);
  }
  drawLoop(picture, true_, own);
  drawSlots(picture, end);
  return moving;
}

/**
 * The plant's own loop. An operator's output of a row is what its memory holds in the next one.
 * @param {Samples} samples
 * @param {Hysteresis} hysteresis
 * @param {number} end
 * @returns {Points}
 */
function trueLoop(samples, {input, operators}, end) {
  const x = [];
  const y = [];
  for (let row = Math.max(0, end - SHOWN); row < end; row += 1) {
    x.push(samples.value(`x.${input}`, row));
    y.push(operators.reduce((sum, {memory}) => sum + samples.value(`x.${memory}`, row + 1), 0));
  }
  return {x, y};
}

/**
 * @param {Samples} samples
 * @param {Hysteresis} hysteresis
 * @param {string} label
 * @param {number} end
 * @returns {Points}
 */
function estimated(samples, {input}, label, end) {
  const x = [];
  const y = [];
  for (let row = Math.max(0, end - SHOWN); row < end; row += 1) {
    x.push(samples.value(`${label}.x.${input}`, row));
    y.push(samples.value(`${label}.v`, row));
  }
  return {x, y};
}

/**
 * @param {Picture} picture
 * @param {Points} true_
 * @param {Points | null} own
 */
function drawLoop(picture, true_, own) {
  const {ctx, loop, x, y, colours, observer} = picture;
  const left = 40 * colours.size;
  const area = {left, w: loop.clientWidth - left - 1, h: loop.clientHeight - 15 * colours.size};
  /** @param {number} value */
  const px = (value) => left + ((value - x.low) / (x.high - x.low)) * area.w;
  /** @param {number} value */
  const py = (value) => area.h - ((value - y.low) / (y.high - y.low)) * area.h;
  drawAxes(picture, area, px, py);
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, 0, area.w, area.h);
  ctx.clip();
  /**
   * @param {Points} points
   * @param {string} colour
   * @param {number[]} dash
   * @param {number} wide
   */
  const curve = (points, colour, dash, wide) => {
    ctx.beginPath();
    points.x.forEach((value, i) => ctx.lineTo(px(value), py(points.y[i])));
    Object.assign(ctx, {strokeStyle: colour, lineWidth: wide, lineJoin: 'round'});
    ctx.setLineDash(dash);
    ctx.stroke();
    ctx.setLineDash([]);
  };
  if (own && observer) curve(own, colours.observers[observer.place % COLOURS], [], 1.4 * colours.size);
  curve(true_, colours.ink, [5, 3], 1.2 * colours.size);
  const last = true_.x.length - 1;
  if (last >= 0) dot(ctx, px(true_.x[last]), py(true_.y[last]), 3.5 * colours.size, colours.ink);
  ctx.restore();
}

/**
 * @param {Picture} picture
 * @param {{left: number, w: number, h: number}} area
 * @param {(value: number) => number} px
 * @param {(value: number) => number} py
 */
function drawAxes({ctx, loop, x, y, colours}, area, px, py) {
  /** @param {number} value @param {number} step */
  const mark = (value, step) => (value === 0 ? '0' : fixed(value, Math.max(0, Math.ceil(-Math.log10(step)))));
  ctx.clearRect(0, 0, loop.clientWidth, loop.clientHeight);
  Object.assign(ctx, {
    font: colours.number,
    fillStyle: colours.soft,
    strokeStyle: colours.grid,
    lineWidth: 1,
    textAlign: 'center',
    textBaseline: 'bottom',
  });
  const stepX = niceStep(x.high - x.low, 3);
  for (const value of marks(x.low, x.high, stepX)) {
    straight(ctx, px(value), 0, px(value), area.h);
    ctx.fillText(
      mark(value, stepX),
      Math.max(area.left + 12, Math.min(area.left + area.w - 14, px(value))),
      loop.clientHeight,
    );
  }
  Object.assign(ctx, {textAlign: 'right', textBaseline: 'middle'});
  const stepY = niceStep(y.high - y.low, 4);
  for (const value of marks(y.low, y.high, stepY)) {
    straight(ctx, area.left, py(value), area.left + area.w, py(value));
    if (py(value) > 6 && py(value) < area.h - 6) ctx.fillText(mark(value, stepY), area.left - 5, py(value));
  }
  ctx.strokeStyle = colours.line;
  ctx.strokeRect(area.left + 0.5, 0.5, area.w - 1, area.h - 1);
}

/**
 * Each operator as a slot of its width around its output; the dot is the input. Where it pushes a wall, the operator
 * follows.
 * @param {Picture} picture
 * @param {number} end
 */
function drawSlots({app, slotCtx: ctx, slots, found, colours, observer, x: range}, end) {
  const width = slots.clientWidth;
  const height = slots.clientHeight;
  if (!found) return;
  const {input, operators} = found;
  const {samples} = app;
  ctx.clearRect(0, 0, width, height);
  const widest = Math.max(...operators.map(({right, left}) => Math.max(right, left)));
  const most = Math.max(widest, Math.abs(range.low), Math.abs(range.high)) * 1.08 + widest * 0.2;
  const name = 52 * colours.size;
  /** @param {number} value */
  const px = (value) => name + ((value + most) / (2 * most)) * (width - name - 4);
  const pitch = height / operators.length;
  const x = samples.value(`x.${input}`, end - 1);
  ctx.strokeStyle = colours.grid;
  straight(ctx, px(0), 0, px(0), height);
  operators.forEach(({memory, right, left}, i) => {
    const y = (i + 0.5) * pitch;
    const z = samples.value(`x.${memory}`, end); // its output in the row before
    const zone = observer ? samples.value(`${observer.label}.zone.${i + 1}`, end - 1) : 0;
    ctx.fillStyle = colours.soft;
    ctx.font = colours.number;
    ctx.textAlign = 'left';
    ctx.textBaseline = 'middle';
    ctx.fillText(`±${fixed(right, 2)}`, 0, y);
    const tall = Math.min(7 * colours.size, pitch * 0.32);
    ctx.strokeStyle = colours.soft;
    ctx.lineWidth = 1;
    straight(ctx, px(z - left), y, px(z + right), y);
    const accent = observer ? colours.observers[observer.place % COLOURS] : colours.ink;
    wall(ctx, px(z - left), y, tall, zone === -1 ? accent : colours.soft, zone === -1);
    wall(ctx, px(z + right), y, tall, zone === 1 ? accent : colours.soft, zone === 1);
    dot(ctx, px(x), y, 2.8 * colours.size, colours.ink);
  });
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} x
 * @param {number} y
 * @param {number} tall
 * @param {string} colour
 * @param {boolean} pushed
 */
function wall(ctx, x, y, tall, colour, pushed) {
  ctx.strokeStyle = colour;
  ctx.lineWidth = pushed ? 3 : 1.2;
  straight(ctx, x, y - tall, x, y + tall);
  ctx.lineWidth = 1;
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} x
 * @param {number} y
 * @param {number} radius
 * @param {string} colour
 */
function dot(ctx, x, y, radius, colour) {
  ctx.fillStyle = colour;
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
  ctx.fill();
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} x0
 * @param {number} y0
 * @param {number} x1
 * @param {number} y1
 */
function straight(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}
