// The whole session as a video editor shows it: faults as bars, alarms as flags, changes as ticks. Dragging looks back
// and gives up nothing;
// going back or forking from there is a button at the place.

import {context, fill, h, query} from '../../common/dom.js';
import {marks, niceStep} from '../scope/axes.js';
import {palette} from '../scope/canvas.js';
import {hatch} from '../scope/hatch.js';
import {seconds} from '../../widgets/number-format.js';
import {mountFlags} from '../notes/note-flags.js';
import {lines} from './event-words.js';
import {stand, watchRoom} from './free-place.js';
import {t} from '../../i18n/words.js';

/** @import {App, Palette} from '../types.js' */

/**
 * The timeline with its canvas.
 * @typedef {object} Timeline
 * @property {App} app
 * @property {HTMLElement} root
 * @property {HTMLCanvasElement} canvas
 * @property {HTMLElement} slider
 * @property {HTMLElement} choice
 * @property {CanvasRenderingContext2D} ctx
 * @property {Palette} colours
 * @property {string} still
 * @property {number} width
 * @property {number} height
 */

const NEAR = 6; // px
const CHANGES = new Set(['gain', 'signal', 'noise', 'observer-added', 'observer-removed']);

/** @param {HTMLElement} root @param {App} app */
export function mountTimeline(root, app) {
  const canvas = h('canvas', {'aria-hidden': 'true'});
  const slider = h(
    'div',
    {class: 'rail', role: 'slider', tabindex: 0, 'aria-valuemin': 0, 'aria-valuemax': 0, 'aria-valuenow': 0},
    canvas,
  );
  const choice = h('div', {class: 'choice', hidden: true});
  fill(root, slider, choice);
  /** @type {Timeline} */
  const timeline = {
    app,
    root,
    canvas,
    slider,
    choice,
    ctx: context(canvas),
    colours: palette(),
    still: '',
    width: 0,
    height: 0,
  };
  new ResizeObserver(() => measure(timeline)).observe(canvas);
  watchRoom(() => place(timeline));
  app.subscribe(
    (state) => [state.theme, state.presentation],
    () => {
      timeline.colours = palette();
      measure(timeline);
    },
  );
  app.subscribe(
    (state) => [
      state.faults,
      state.log.length,
      state.session,
      state.alarms,
      state.selection,
      state.spec?.horizon,
      state.facts?.judged,
    ],
    () => {
      timeline.still = '';
      app.wake();
    },
  );
  app.subscribe(
    (state) => [state.looking, state.role, state.language, state.presentation],
    ([looking]) => {
      timeline.still = '';
      offer(timeline, looking);
      app.wake();
    },
  );
  app.subscribe(
    (state) => state.language,
    () => {
      slider.setAttribute('aria-label', t('page.timeline.label'));
      slider.title = t('page.timeline.hint');
    },
  );
  app.onFrame(() => draw(timeline));
  app.onTick(() => speak(timeline));
  listen(timeline);
  mountFlags(root, app, () => reach(timeline));
}

/**
 * Where the rail ends: the horizon, or where time has come to and some room.
 * @param {Pick<Timeline, 'app'>} timeline
 */
function reach({app}) {
  const {now} = app.samples;
  const horizon = app.state.spec?.horizon ?? 100;
  if (now <= horizon) return horizon;
  const step = niceStep(now, 4);
  return Math.ceil((now * 1.02) / step) * step;
}

/** @param {Timeline} timeline */
function measure(timeline) {
  const {canvas, ctx} = timeline;
  const ratio = Math.min(3, devicePixelRatio || 1);
  timeline.width = canvas.clientWidth;
  timeline.height = canvas.clientHeight;
  canvas.width = Math.round(timeline.width * ratio);
  canvas.height = Math.round(timeline.height * ratio);
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  timeline.still = '';
  timeline.app.wake();
}

/** @param {Timeline} timeline */
function draw(timeline) {
  const {app, ctx, width, height, colours} = timeline;
  const {state} = app;
  const end = reach(timeline);
  const now = app.edge.t;
  /** @param {number} t */
  const x = (t) => (t / end) * width;
  const shown = `${Math.round(x(now) * 2)} ${end} ${state.looking} ${state.selection}`;
  if (shown === timeline.still || width === 0) return false;
  timeline.still = shown;
  const foot = 13 * colours.size;
  const top = 4;
  const body = height - foot - top;
  ctx.clearRect(0, 0, width, height);
  ctx.fillStyle = colours.grid;
  ctx.fillRect(0, top, width, body);
  ctx.fillStyle = colours.line;
  ctx.fillRect(0, top, x(now), body);
  if (state.selection) {
    ctx.fillStyle = colours.soft;
    ctx.globalAlpha = 0.25;
    ctx.fillRect(x(state.selection[0]), top, Math.max(2, x(state.selection[1]) - x(state.selection[0])), body);
    ctx.globalAlpha = 1;
  }
  drawFaults(timeline, x, now, end, top, body);
  drawJudged(timeline, x, now, top, body);
  drawEvents(timeline, x, top, body);
  ctx.fillStyle = colours.ink;
  ctx.fillRect(Math.round(x(now)) - 1, 0, 2, top + body + 3);
  if (state.looking !== null) {
    ctx.fillStyle = colours.accent;
    ctx.fillRect(Math.round(x(state.looking)) - 1, 0, 2, top + body + 3);
  }
  ctx.fillStyle = colours.soft;
  ctx.font = colours.number;
  ctx.textAlign = 'center';
  ctx.textBaseline = 'bottom';
  const step = niceStep(end, Math.max(2, width / (90 * colours.size)));
  for (const t of marks(0, end, step)) ctx.fillText(String(t), Math.min(Math.max(x(t), 8), width - 14), height);
  return false;
}

/**
 * One thin row for each channel or output that has a fault; planned faults are drawn faintly.
 * @param {Timeline} timeline
 * @param {(t: number) => number} x
 * @param {number} now
 * @param {number} end
 * @param {number} top
 * @param {number} body
 */
function drawFaults({app, ctx, colours}, x, now, end, top, body) {
  const {faults} = app.state;
  const subjects = [...new Set(faults.map(({subject}) => subject))];
  const pitch = Math.min(7, (body - 6) / Math.max(1, subjects.length));
  for (const fault of faults) {
    const y = top + 5 + subjects.indexOf(fault.subject) * pitch;
    const tall = Math.max(1.5, pitch * 0.6);
    /**
     * @param {number} from
     * @param {number} to
     * @param {number} alpha
     */
    const bar = (from, to, alpha) => {
      if (to <= from) return;
      ctx.globalAlpha = alpha;
      ctx.fillRect(x(from), y, Math.max(2, x(to) - x(from)), tall);
      ctx.globalAlpha = 1;
    };
    ctx.fillStyle = colours.amber;
    bar(fault.onset, Math.min(fault.end ?? now, now), 1);
    bar(Math.max(now, fault.onset), Math.min(fault.end ?? end, end), 0.28);
    if (fault.onset <= 0 || fault.onset > end) continue;
    ctx.fillStyle = colours.fault; // where it begins, as others may act there already
    ctx.globalAlpha = fault.onset > now ? 0.5 : 1;
    ctx.fillRect(Math.round(x(fault.onset)), y - 1, 1.5, tall + 2);
    ctx.globalAlpha = 1;
  }
}

/**
 * @param {Timeline} timeline
 * @param {(t: number) => number} x
 * @param {number} top
 * @param {number} body
 */
function drawEvents({app, ctx, colours}, x, top, body) {
  ctx.fillStyle = colours.alarm;
  for (const alarm of app.state.alarms) {
    ctx.beginPath();
    ctx.moveTo(x(alarm.t) - 4, top - 4);
    ctx.lineTo(x(alarm.t) + 4, top - 4);
    ctx.lineTo(x(alarm.t), top + 3);
    ctx.fill();
  }
  ctx.fillStyle = colours.ink;
  for (const event of app.state.log) {
    if (CHANGES.has(event.kind)) ctx.fillRect(Math.round(x(event.t)), top + body - 6, 1.5, 6);
    else if (event.kind === 'diverged') cross(ctx, x(event.t), top + body - 7, colours.alarm);
  }
}

/**
 * Hatching from where the detector has judged to, while it is behind, and the words where there is room for them.
 * @param {Timeline} timeline
 * @param {(t: number) => number} x
 * @param {number} now
 * @param {number} top
 * @param {number} body
 */
function drawJudged({app, ctx, colours}, x, now, top, body) {
  const judged = app.state.facts?.judged ?? null;
  if (judged === null || judged >= now) return;
  const at = Math.round(x(judged));
  ctx.fillStyle = colours.card;
  ctx.fillRect(at, top, x(now) - at, body);
  hatch(ctx, {left: at, right: x(now), top, bottom: top + body}, colours.soft);
  ctx.fillStyle = colours.soft;
  ctx.fillRect(at, top, 1, body);
  ctx.font = colours.number;
  const words = t('page.timeline.judged');
  if (new Set(app.state.faults.map(({subject}) => subject)).size > 2) return; // their bars need the place
  if (ctx.measureText(words).width > at - 8) return;
  ctx.textAlign = 'right';
  ctx.textBaseline = 'bottom';
  ctx.fillText(words, at - 4, top + body);
}

/**
 * @param {CanvasRenderingContext2D} ctx
 * @param {number} x
 * @param {number} y
 * @param {string} colour
 */
function cross(ctx, x, y, colour) {
  Object.assign(ctx, {strokeStyle: colour, lineWidth: 2});
  ctx.beginPath();
  for (const [dx, dy] of [
    [-3.5, -3.5],
    [-3.5, 3.5],
  ]) {
    ctx.moveTo(x + dx, y + dy);
    ctx.lineTo(x - dx, y - dy);
  }
  ctx.stroke();
}

/**
 * The actions offered at the time that is looked at.
 * @param {Timeline} timeline
 * @param {number | null} at
 */
function offer(timeline, at) {
  const {app, choice} = timeline;
  const {act} = app;
  choice.hidden = at === null;
  if (at === null) return;
  const may = app.state.role === 'control';
  fill(
    choice,
    h('span', {}, t('page.timeline.looking-at', {t: seconds(at, 0.1)})),
    may &&
      h(
        'button',
        {type: 'button', class: 'run', title: t('page.timeline.continue.hint'), onclick: () => act.seek(at)},
        t('page.timeline.continue'),
      ),
    may &&
      h(
        'button',
        {type: 'button', class: 'quiet', title: t('page.timeline.fork.hint'), onclick: () => act.fork(at)},
        t('page.timeline.fork'),
      ),
    h('button', {type: 'button', class: 'quiet', onclick: () => act.look(null)}, t('page.timeline.now')),
  );
  place(timeline);
}

/** @param {Timeline} timeline */
function place({app, choice, root}) {
  if (choice.hidden) return;
  stand(choice, {narrow: (on) => choice.classList.toggle('short', on)});
  if (!app.state.presentation || getComputedStyle(root.parentElement ?? root).display !== 'contents') return;
  const {left, width} = root.getBoundingClientRect(); // while presenting: over the scope's legend, below its time
  const scope = query('#scope').getBoundingClientRect();
  const wide = choice.offsetWidth;
  const middle = ((app.state.looking ?? 0) / reach({app})) * width;
  choice.style.left = `${Math.max(scope.left - left, Math.min(middle - wide / 2, scope.right - left - wide))}px`;
}

/** @param {Timeline} timeline */
function listen(timeline) {
  const {slider, app} = timeline;
  /** @param {PointerEvent} event */
  const timeAt = (event) => {
    const box = slider.getBoundingClientRect();
    const t = Math.min(app.samples.now, Math.max(0, ((event.clientX - box.left) / box.width) * reach(timeline)));
    return Math.round(t / app.state.record) * app.state.record;
  };
  /** @param {number} t */
  const go = (t) => app.act.look(t >= app.samples.now ? null : Math.max(0, t));
  slider.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !app.state.record) return;
    slider.setPointerCapture(event.pointerId);
    go(timeAt(event));
  });
  slider.addEventListener('pointermove', (event) => {
    if (slider.hasPointerCapture(event.pointerId)) go(timeAt(event));
    else slider.title = near(timeline, event) || t('page.timeline.hint');
  });
  slider.addEventListener('keydown', (event) => {
    const by = reach(timeline) / 100;
    const {looking, role} = app.state;
    const from = looking ?? app.samples.now;
    /** @type {{[key: string]: (() => unknown) | false}} */
    const keys = {
      ArrowLeft: () => go(from - by),
      ArrowRight: () => go(from + by),
      Home: () => go(0),
      End: () => go(Infinity),
      Escape: looking !== null && (() => app.act.look(null)),
      Enter: () => looking !== null && role === 'control' && app.act.seek(looking),
    };
    const move = keys[event.key];
    if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    move();
  });
}

/**
 * The lines of the log near the pointer.
 * @param {Timeline} timeline
 * @param {PointerEvent} event
 */
function near({app, slider, width, ...timeline}, event) {
  const {state} = app;
  const x = event.clientX - slider.getBoundingClientRect().left;
  const end = reach({app, ...timeline});
  const nearby = lines(state.log, state.plant).filter((line) => Math.abs((line.t / end) * width - x) < NEAR);
  return nearby
    .slice(0, 5)
    .reverse()
    .map((line) => t('page.events.at', {t: seconds(line.t, state.record >= 1 ? 1 : 0.1), event: line.words}))
    .join('\n');
}

/** @param {Timeline} timeline */
function speak({app, slider}) {
  const t = app.state.looking ?? app.samples.now;
  slider.setAttribute('aria-valuenow', t.toFixed(1));
  slider.setAttribute('aria-valuemax', app.samples.now.toFixed(1));
  slider.setAttribute('aria-valuetext', `${t.toFixed(1)} s`);
}
