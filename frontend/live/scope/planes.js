// Phase planes below the strips: any quantity over any other, for the time that the scope shows.

import {context, fill, h} from '../../common/dom.js';
import {called, plain} from '../../common/names.js';
import {fixed} from '../../widgets/number-format.js';
import {COLOURS, DASH_DOT} from '../../widgets/line-style.js';
import {icon} from '../../widgets/svg.js';
import {curvesOf, quantitiesOf} from '../state/planes.js';
import {Range, marks, niceStep} from './axes.js';
import {palette} from './canvas.js';
import {moment} from './values.js';
import {t} from '../../i18n/words.js';

/** @import {App, Palette, Samples} from '../types.js' */
/** @import {Plane, PlaneCurve, Quantity} from '../state/planes.js' */

const POINTS = 1200; // of a curve
const TRIMMED = 0.04; // share of an estimate's outermost values that do not set the scale
const AIM = 300; // ms between fits of the axes

/**
 * A plane with its canvas.
 * @typedef {object} Figure
 * @property {HTMLCanvasElement} canvas
 * @property {CanvasRenderingContext2D} ctx
 * @property {PlaneCurve[]} curves
 * @property {Range} x
 * @property {Range} y
 * @property {number} aimed
 */

/** @typedef {{x: number[], y: number[]}} Points */

/** @param {HTMLElement} root @param {App} app */
export function mountPlanes(root, app) {
  /** @type {Figure[]} */
  let figures = [];
  let colours = palette();
  let still = '';
  const again = () => {
    still = '';
    for (const {canvas, ctx} of figures) {
      const ratio = Math.min(3, devicePixelRatio || 1);
      canvas.width = Math.round(canvas.clientWidth * ratio);
      canvas.height = Math.round(canvas.clientHeight * ratio);
      ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    app.wake();
  };
  const build = () => {
    const {state} = app;
    const quantities = quantitiesOf(state);
    root.hidden = state.planes.length === 0 || quantities.length === 0;
    figures = [];
    const shown = state.planes.map((plane, place) => {
      const [x, y] = [plane.x, plane.y].map((id) => quantities.find((one) => one.id === id));
      const canvas = h('canvas', {role: 'img'});
      if (x && y) {
        canvas.setAttribute('aria-label', t('page.planes.picture', {x: wordsOf(x, app), y: wordsOf(y, app)}));
        const curves = curvesOf(x, y, state);
        figures.push({canvas, ctx: context(canvas), curves, x: new Range(), y: new Range(), aimed: -Infinity});
      }
      return figureOf(place, plane, canvas, quantities, app);
    });
    fill(root, h('h2', {class: 'visually-hidden'}, t('page.planes.title')), shown);
    again();
  };
  /** @param {number} now */
  const draw = (now) => {
    if (root.hidden || figures.length === 0) return false;
    const [t0, t1] = app.span();
    const end = Math.min(t1, moment(app.state, app.samples.now));
    const shown = `${app.samples.version} ${t0} ${end}`;
    const moving = figures.map(({x, y}) => [x.move(now), y.move(now)].includes(true)).includes(true);
    if (shown === still && !moving) return false;
    still = shown;
    for (const figure of figures) drawFigure(figure, app, colours, t0, end, now);
    return moving;
  };
  app.subscribe((s) => [s.planes, s.plant, s.columns, s.observers, s.language, s.lesson], build);
  app.subscribe(
    (s) => [s.theme, s.presentation],
    () => {
      colours = palette();
      again();
    },
  );
  new ResizeObserver(again).observe(root);
  app.onFrame(draw);
}

/**
 * The words of a quantity, as the choices show it.
 * @param {Quantity} quantity
 * @param {App} app
 */
function wordsOf({kind, name}, app) {
  if (kind === 'estimated') return t('page.planes.estimated', {name: plain(name)});
  if (kind === 'residual') return t('page.planes.residual', {name: plain(name)});
  const words = called(name, app.state.plant);
  return words === plain(name) ? words : t('page.planes.named', {name: plain(name), words});
}

/**
 * A plane with the choices of its axes, and the button that removes it.
 * @param {number} place
 * @param {Plane} plane
 * @param {HTMLCanvasElement} canvas
 * @param {Quantity[]} quantities
 * @param {App} app
 */
function figureOf(place, plane, canvas, quantities, app) {
  /** @param {'x' | 'y'} axis */
  const choice = (axis) =>
    h(
      'select',
      {
        class: `axis-${axis}`,
        'aria-label': axis === 'x' ? t('page.planes.across') : t('page.planes.up'),
        onchange: ({currentTarget}) => app.act.plane(place, {...plane, [axis]: currentTarget.value}),
      },
      quantities.map((one) => h('option', {value: one.id, selected: one.id === plane[axis]}, wordsOf(one, app))),
    );
  const remove = h(
    'button',
    {
      type: 'button',
      class: 'plain',
      'aria-label': t('page.planes.remove'),
      title: t('page.planes.remove'),
      onclick: () => app.act.plane(place, null),
    },
    icon('close', 13),
  );
  return h('figure', {class: 'plane'}, h('div', {class: 'plane-head'}, choice('y'), remove), canvas, choice('x'));
}

/**
 * The points of a curve between two times; rows are counted from t = 0, so that a curve that moves on does not shimmer.
 * @param {Samples} samples
 * @param {PlaneCurve} curve
 * @param {number} t0
 * @param {number} t1
 * @returns {Points}
 */
export function pointsOf(samples, curve, t0, t1) {
  const first = Math.max(0, Math.ceil(t0 / samples.record - 1e-6));
  const last = Math.min(samples.rows - 1, Math.floor(t1 / samples.record + 1e-6));
  const each = 2 ** Math.max(0, Math.ceil(Math.log2(Math.max(1, last - first) / POINTS)));
  /** @type {Points} */
  const points = {x: [], y: []};
  /** @param {number} row */
  const take = (row) => {
    points.x.push(samples.value(curve.x, row));
    points.y.push(samples.value(curve.y, row));
  };
  for (let row = Math.ceil(first / each) * each; row <= last; row += each) take(row);
  if (last >= first && last % each !== 0) take(last);
  return points;
}

/**
 * The range of values without the outermost ones.
 * @param {number[]} values
 * @param {number} trimmed
 */
function reach(values, trimmed) {
  const known = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (known.length === 0) return null;
  const cut = Math.floor(trimmed * known.length);
  return [known[cut], known[known.length - 1 - cut]];
}

/**
 * @param {Figure} figure
 * @param {App} app
 * @param {Palette} colours
 * @param {number} t0
 * @param {number} end
 * @param {number} now
 */
function drawFigure(figure, app, colours, t0, end, now) {
  const {canvas, ctx, curves, x, y} = figure;
  const all = curves.map((curve) => ({curve, points: pointsOf(app.samples, curve, t0, end)}));
  if (now - figure.aimed > AIM || x.target === null) {
    figure.aimed = now;
    for (const [range, axis] of /** @type {const} */ ([
      [x, 'x'],
      [y, 'y'],
    ])) {
      const ends = all.flatMap(({curve, points}) => reach(points[axis], curve.label === null ? 0 : TRIMMED) ?? []);
      if (ends.length) range.aim(Math.min(...ends), Math.max(...ends), now);
    }
  }
  const left = 46 * colours.size;
  const area = {left, w: canvas.clientWidth - left - 1, h: canvas.clientHeight - 15 * colours.size};
  ctx.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  if (x.target === null || y.target === null || area.w <= 0) return;
  /** @param {number} value */
  const px = (value) => left + ((value - x.low) / (x.high - x.low)) * area.w;
  /** @param {number} value */
  const py = (value) => area.h - ((value - y.low) / (y.high - y.low)) * area.h;
  drawAxes(figure, colours, area, px, py);
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, 0, area.w, area.h);
  ctx.clip();
  ctx.lineJoin = 'round';
  for (const {curve, points} of all) {
    const observer = app.state.observers.find(({label}) => label === curve.label);
    const alone = curves.length === 1;
    ctx.strokeStyle = observer ? colours.observers[observer.place % COLOURS] : colours.ink;
    ctx.lineWidth = 1.3 * colours.size;
    const dash = observer ? (observer.dashed ? DASH_DOT : []) : alone ? [] : [5, 3];
    ctx.setLineDash(dash.map((length) => length * colours.size));
    ctx.beginPath();
    points.x.forEach((value, i) => {
      if (Number.isFinite(value) && Number.isFinite(points.y[i])) ctx.lineTo(px(value), py(points.y[i]));
    });
    ctx.stroke();
    ctx.setLineDash([]);
    const last = points.x.length - 1;
    if (last < 0 || !Number.isFinite(points.x[last])) continue;
    ctx.fillStyle = ctx.strokeStyle;
    ctx.beginPath();
    ctx.arc(px(points.x[last]), py(points.y[last]), 3.2 * colours.size, 0, 2 * Math.PI);
    ctx.fill();
  }
  ctx.restore();
}

/**
 * @param {Figure} figure
 * @param {Palette} colours
 * @param {{left: number, w: number, h: number}} area
 * @param {(value: number) => number} px
 * @param {(value: number) => number} py
 */
function drawAxes({ctx, canvas, x, y}, colours, area, px, py) {
  /** @param {number} value @param {number} step */
  const mark = (value, step) => (value === 0 ? '0' : fixed(value, Math.max(0, Math.ceil(-Math.log10(step)))));
  Object.assign(ctx, {font: colours.number, fillStyle: colours.soft, strokeStyle: colours.grid, lineWidth: 1});
  /** @param {number[]} from @param {number[]} to */
  const line = (from, to) => {
    ctx.beginPath();
    ctx.moveTo(from[0], from[1]);
    ctx.lineTo(to[0], to[1]);
    ctx.stroke();
  };
  Object.assign(ctx, {textAlign: 'center', textBaseline: 'bottom'});
  const stepX = niceStep(x.high - x.low, Math.max(2, area.w / (70 * colours.size)));
  for (const value of marks(x.low, x.high, stepX)) {
    line([px(value), 0], [px(value), area.h]);
    const at = Math.max(area.left + 14, Math.min(area.left + area.w - 16, px(value)));
    ctx.fillText(mark(value, stepX), at, canvas.clientHeight);
  }
  Object.assign(ctx, {textAlign: 'right', textBaseline: 'middle'});
  const stepY = niceStep(y.high - y.low, 4);
  for (const value of marks(y.low, y.high, stepY)) {
    line([area.left, py(value)], [area.left + area.w, py(value)]);
    if (py(value) > 6 && py(value) < area.h - 6) ctx.fillText(mark(value, stepY), area.left - 5, py(value));
  }
  ctx.strokeStyle = colours.line;
  ctx.strokeRect(area.left + 0.5, 0.5, area.w - 1, area.h - 1);
}
