// The scope: strips on one time axis. This file lays them out and draws them; head.js and pointer.js are its controls.

import {fill, h, symbol} from '../../common/dom.js';
import {badges, brief, plain, split, symbolic} from '../../common/names.js';
import {niceStep, Range} from './axes.js';
import {drawStrip, drawTimeAxis, palette} from './canvas.js';
import {openFigure} from './figure.js';
import {mountHead} from './head.js';
import {mountPointer} from './pointer.js';
import {showValues} from './values.js';
import {untold} from '../../diagnosis/fault-size.js';
import {leaving, setTicks, wanted} from './axis-view.js';
import {stripsOf} from '../state/strips.js';
import {say, t} from '../../i18n/words.js';

/** @import {Plant} from '../../pages/types.js' */
/** @import {App, Row, Strip} from '../types.js' */

const AIM = 300; // ms between looks at what the axes should show
const GUTTER = 52; // px for the marks of the vertical axis
const LINE = 14.3; // px of one number beside a strip

/** @param {HTMLElement} root @param {App} app */
export function mountScope(root, app) {
  const scope = new Scope(root, app);
  app.subscribe(
    (state) => [
      state.plant,
      state.columns,
      state.observers,
      state.faults,
      state.checks,
      state.strips,
      state.noise,
      state.language,
      state.presentation,
    ],
    () => scope.build(),
  );
  app.subscribe(
    (state) => [state.plant, state.selection, state.window, state.session],
    () => scope.refit(),
  );
  app.subscribe(
    (state) => state.language,
    () => {
      scope.title.textContent = t('page.scope.title');
    },
  );
  app.subscribe(
    (state) => [state.theme, state.presentation],
    () => scope.restyle(),
  );
  app.subscribe(
    (state) => [state.connection, state.alarms, state.log.length, state.band],
    () => {
      scope.still = '';
      app.wake();
    },
  );
  app.subscribe(
    (state) =>
      untold(state)
        .map((one) => `${one.channel} ${one.smallest === null}`)
        .join(),
    () => scope.showUntold(),
  );
  app.subscribe(
    (state) => [state.cursor, state.looking],
    () => app.wake(),
  ); // the numbers follow while time stands still, too
  app.onFrame((now) => scope.draw(now));
  app.onTick(() => scope.showValues());
  return scope;
}

export class Scope {
  /** @param {HTMLElement} root @param {App} app */
  constructor(root, app) {
    Object.assign(this, {app, rows: new Map(), strips: [], colours: palette(), aimed: 0, atOnce: true, still: ''});
    this.head = h('div', {class: 'scope-head'});
    this.list = h('div', {class: 'strips'});
    this.axis = h('canvas', {class: 'time-axis', 'aria-hidden': 'true'});
    this.empty = h('p', {class: 'scope-empty', hidden: true});
    this.plots = h('div', {class: 'plots'}, this.list, this.axis);
    this.title = h('h2', {class: 'hidden'});
    fill(root, this.title, this.head, this.plots, this.empty);
    mountHead(this.head, app, this);
    this.pointer = mountPointer(this.plots, app, this);
    new ResizeObserver(() => this.measure()).observe(this.list);
  }

  /** Make the rows anew where the strips have changed; rows that stay keep their axes. */
  build() {
    const {state} = this.app;
    this.strips = stripsOf(state);
    const shown = this.strips.filter((strip) => strip.shown);
    for (const strip of shown) {
      const row = this.rows.get(strip.name) ?? createRow();
      this.rows.set(strip.name, row);
      row.strip = {...strip, ticks: [], labels: [], power: ''};
      this.label(row);
    }
    const wanted = shown.map((strip) => this.rows.get(strip.name).element);
    for (const name of [...this.rows.keys()]) if (!shown.some((strip) => strip.name === name)) this.rows.delete(name);
    if (wanted.length !== this.list.children.length || wanted.some((element, i) => this.list.children[i] !== element)) {
      this.list.replaceChildren(...wanted);
    }
    this.showUntold();
    this.measure();
    this.showEmpty();
    this.aimed = 0;
    this.still = '';
    this.app.wake();
  }

  /** @param {Row} row */
  label(row) {
    const {strip} = row;
    const words =
      {residual: t('page.scope.residual'), excitation: t('page.scope.excitation')}[strip.kind] ?? brief(strip.title);
    const [letters, index] = split(strip.symbol);
    const wordy = strip.kind === 'excitation' ? false : letters.length > 1 || index.length > 3;
    const unit = strip.unit ? ` ${strip.unit}` : '';
    const open = tool('open', 'M9.500 3H13v3.500M13 3L9 7M6.500 13H3V9.500M3 13l4-4', () =>
      openFigure(this.app, strip.name),
    );
    open.title = t('page.scope.open-figure');
    open.setAttribute('aria-label', t('page.scope.open-figure-of', {strip: words}));
    row.all ??= tool('all', 'M8 2v12M5 4.500L8 2l3 2.500M5 11.500L8 14l3-2.500', () => this.showAll(row));
    row.all.dataset.name = words;
    this.labelAll(row);
    row.plot.append(row.all);
    fill(
      row.label,
      h('span', {class: `sign${wordy ? ' wordy' : ''}`}, signOf(strip, this.app.state.plant)),
      open,
      h('small', {title: words + unit}, words),
    );
    row.element.style.setProperty('--weight', strip.weight);
    row.element.dataset.kind = strip.kind;
    row.element.dataset.strip = strip.name;
    row.element.classList.toggle(
      'fault-on',
      strip.kind === 'theta' && this.app.state.faults.some(({subject, active}) => active && subject === strip.subject),
    );
    row.canvas.dataset.name = [symbolic(strip.symbol) && plain(strip.symbol), words].filter(Boolean).join(' ');
    row.canvas.setAttribute('aria-label', row.canvas.dataset.name);
    const own = strip.traces.map((trace) =>
      h('span', {
        style: `--c:${strip.log && strip.traces.length === 1 ? 'var(--ok)' : trace.colour}`,
        'data-label': trace.label,
      }),
    );
    row.values.style.setProperty('--lines', Math.ceil((own.length + (strip.truth ? 1 : 0)) / 2));
    fill(
      row.values,
      strip.truth && h('span', {class: 'truth'}),
      own,
      strip.log && own.length === 1 && h('span', {class: 'judged', style: '--c:var(--ok)', 'data-label': ''}),
    );
  }

  /** Say which faults the input of the last window does not tell. */
  showUntold() {
    const {state} = this.app;
    const lost = untold(state);
    for (const {strip, untold: mark} of this.rows.values()) {
      if (strip.kind === 'excitation') continue;
      const one = strip.kind === 'theta' ? lost.find(({channel}) => channel === strip.subject) : undefined;
      mark.hidden = one === undefined;
      mark.textContent =
        one?.smallest === null ? t('page.diagnosis.not-identifiable') : t('page.detectability.below-noise');
    }
  }

  /** Axes look again, at once: the old ranges mean nothing to another plant or another window. */
  refit() {
    this.atOnce = true;
    this.aimed = 0;
    this.still = '';
    this.app.wake();
  }

  restyle() {
    this.colours = palette();
    this.measure();
  }

  /** Fit the canvases to their places. */
  measure() {
    const ratio = Math.min(3, devicePixelRatio || 1);
    const crowded = [...this.rows.values()].some(
      ({element, values}) => values.childElementCount * LINE * this.colours.size > element.clientHeight,
    );
    this.list.classList.toggle('many', crowded); // numbers in two columns; the heights stay
    for (const row of this.rows.values()) fit(row, row.canvas, ratio, GUTTER * this.colours.size);
    const [first] = this.rows.values();
    if (first) {
      const box = first.canvas.getBoundingClientRect();
      const plots = this.plots.getBoundingClientRect();
      this.axis.style.marginLeft = `${box.left - plots.left}px`;
      this.axis.style.width = `${box.width}px`;
      fit(this, this.axis, ratio, GUTTER * this.colours.size);
      this.pointer.measure(box.left - plots.left + this.place.left, this.place.width);
    }
    this.still = '';
    this.app.wake();
  }

  /** The times at the edges. */
  span() {
    const {window, selection} = this.app.state;
    if (selection) return selection;
    const edge = this.app.edge.t;
    const length = window ?? Math.max(edge, 10);
    const t1 = Math.max(edge, length);
    return [t1 - length, t1];
  }

  /** @param {number} now */
  draw(now) {
    const {app} = this;
    const {state, samples, ghost} = app;
    const moving = app.edge.move(
      now,
      samples.now,
      state.rate || state.speed || 1,
      state.playing && state.connection === 'live',
    );
    if (this.rows.size === 0 || !this.place) return moving;
    const [t0, t1] = this.span();
    const shown = `${samples.version} ${ghost?.version} ${t0} ${t1}`;
    const gliding = this.aim(now, t0, t1);
    if (shown === this.still && !gliding && !moving) return false;
    this.still = shown;
    const step = niceStep(t1 - t0, Math.max(2, this.place.width / (78 * this.colours.size)));
    const view = {
      t0,
      t1,
      step,
      samples,
      ghost,
      now: samples.now,
      row: samples.record,
      faults: state.faults,
      alarms: state.alarms,
      bands: this.bands(),
    };
    for (const row of this.rows.values()) {
      if (row.place.height > 0) drawStrip(row.ctx, row.strip, row.place, view, row.range, this.colours);
    }
    drawTimeAxis(this.ctx, this.place, view, this.colours);
    return moving || gliding;
  }

  /**
   * Only this observer's band is drawn while its name is pointed at.
   * @param {string | null} label
   */
  point(label) {
    this.pointed = label;
    this.still = '';
    this.app.wake();
  }

  /** Whose bands are drawn: the one that is pointed at or was chosen, else all. */
  bands() {
    const {observers, band} = this.app.state;
    /** @param {string} label */
    const known = (label) => observers.some((one) => one.label === label);
    const chosen = [this.pointed, band].find(known);
    return new Set(chosen ? [chosen] : observers.map(({label}) => label));
  }

  /**
   * Let every axis see what it should; whether one is still gliding.
   * @param {number} now
   * @param {number} t0
   * @param {number} t1
   */
  aim(now, t0, t1) {
    const shown = `${this.app.samples.version} ${t0} ${t1}`;
    const due = this.seen !== shown; // look once more after the last change, too
    const look = now - this.aimed > AIM || (due && this.atOnce);
    if (look) [this.aimed, this.seen] = [now, shown];
    const settled = this.app.samples.rows > 1 && this.app.samples.rows >= this.app.state.row;
    let gliding = false;
    for (const row of this.rows.values()) {
      const {strip, range, place} = row;
      if (look) this.look(row, t0, t1, now);
      gliding = range.move(now) || gliding;
      if (look || gliding) setTicks(strip, range, place.height / this.colours.size);
    }
    if (look && settled) this.atOnce = false;
    return gliding || due;
  }

  /**
   * What one axis should show, and which curves leave it.
   * @param {Row} row
   * @param {number} t0
   * @param {number} t1
   * @param {number} now
   */
  look(row, t0, t1, now) {
    const {strip, range} = row;
    const {samples} = this.app;
    range.aim(...wanted(strip, samples, t0, t1, row.whole), now, this.atOnce);
    strip.leaving = leaving(strip, samples, t0, t1, range.target ?? [-Infinity, Infinity]);
    row.all.classList.toggle('needed', row.whole || strip.leaving.length > 0);
  }

  /**
   * Show all of a strip's curves, wherever they go, or again what its axis usually holds.
   * @param {Row} row
   * @param {boolean} [whole]
   */
  showAll(row, whole = !row.whole) {
    row.whole = whole;
    row.range.show(...wanted(row.strip, this.app.samples, ...this.span(), whole), performance.now());
    this.labelAll(row);
    this.aimed = 0;
    this.still = '';
    this.app.wake();
  }

  /** @param {Row} row */
  labelAll({all, whole}) {
    const action = whole ? t('page.scope.usual-axis') : t('page.scope.whole-axis');
    all.title = action;
    all.setAttribute('aria-label', t('page.scope.axis-of', {action, strip: all.dataset.name}));
    all.setAttribute('aria-pressed', String(Boolean(whole)));
  }

  /** What stands where there are no curves (yet). */
  showEmpty() {
    const {state, samples} = this.app;
    const words = ['ended', 'failed', 'full'].includes(state.connection)
      ? ''
      : !state.plant
        ? t('page.scope.starting')
        : this.rows.size === 0
          ? t('page.scope.no-strips')
          : samples.rows < 2 && !state.playing
            ? t('page.scope.nothing-yet')
            : '';
    this.empty.hidden = words === '';
    if (this.empty.textContent !== words) this.empty.textContent = words;
  }

  showValues() {
    const {state} = this.app;
    this.showEmpty();
    if (state.playing && !state.selection) this.pointer.refresh();
    showValues(this.rows.values(), this.app);
    this.showNoExcitation();
  }

  /** Why no observer tells the excitation yet. */
  showNoExcitation() {
    const {state, samples} = this.app;
    const row = this.rows.get('excitation');
    if (!row) return;
    const told = row.strip.traces.some(({column}) => Number.isFinite(samples.latest(column)));
    const why = told
      ? null
      : row.strip.traces
          .flatMap(({label}) => state.checks[label] ?? [])
          .find(({name, value}) => /excit/i.test(name) && value === null);
    row.untold.hidden = !why;
    const words = why ? say(why.text) : '';
    if (row.untold.textContent !== words) row.untold.textContent = words;
  }
}

/**
 * What a strip is called in mathematics; a channel that is a word has the letters of its badge in the plant.
 * @param {Strip} strip
 * @param {Plant} plant
 */
function signOf({kind, symbol: name}, plant) {
  if (kind === 'excitation') return h('span', {class: 'math'}, h('i', {}, 'λ'), h('sub', {}, 'min'));
  if (kind === 'residual')
    return h(
      'span',
      {class: 'math', style: split(name)[1].length > 5 && 'white-space:normal;font-size:1rem'},
      symbol(name),
      ' − ',
      symbol(name, true),
    );
  if (kind !== 'theta') return symbol(name);
  const [letters, index] = badges(plant.channels).get(name);
  return h('span', {class: 'math'}, h('i', {}, letters), index && h('sub', {}, index));
}

/**
 * A small button of a strip.
 * @param {string} name
 * @param {string} d
 * @param {() => void} act
 */
const tool = (name, d, act) =>
  h(
    'button',
    {type: 'button', class: name, onclick: act},
    h(
      'svg',
      {
        viewBox: '0 0 16 16',
        width: 13,
        height: 13,
        fill: 'none',
        stroke: 'currentColor',
        'stroke-width': 1.5,
        'stroke-linecap': 'round',
        'stroke-linejoin': 'round',
        'aria-hidden': 'true',
      },
      h('path', {d}),
    ),
  );

function createRow() {
  const label = h('div', {class: 'strip-label'});
  const canvas = h('canvas', {role: 'img'});
  const values = h('div', {class: 'strip-values', 'aria-hidden': 'true'});
  const mark = h('span', {class: 'untold', hidden: true});
  const plot = h('div', {class: 'strip-plot'}, canvas, mark);
  return {
    label,
    canvas,
    values,
    plot,
    untold: mark,
    ctx: canvas.getContext('2d'),
    range: new Range(),
    element: h('div', {class: 'strip'}, label, plot, values),
    place: {left: 0, width: 0, height: 0, full: 0},
  };
}

/**
 * @param {Drawn} owner
 * @param {HTMLCanvasElement} canvas
 * @param {number} ratio
 * @param {number} gutter
 */
function fit(owner, canvas, ratio, gutter) {
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  owner.ctx ??= canvas.getContext('2d');
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  owner.ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  owner.place = {left: gutter, width: Math.max(0, width - gutter - 1), height, full: width};
}
