// The scope: strips on one time axis. This file lays them out and draws them; scope-head.js and scope-pointer.js are its controls.

import {fill, h, symbol} from '../dom.js';
import {extent, marks, niceStep, Range} from './axes.js';
import {drawStrip, drawTimeAxis, palette} from './canvas.js';
import {openFigure} from './figure.js';
import {decimals, fixed} from './format.js';
import {mountHead} from './scope-head.js';
import {mountPointer} from './scope-pointer.js';
import {untold} from './panels/sizes.js';
import {badges, plain, split, symbolic} from './panels/symbols.js';
import {stripsOf} from './strips.js';

const AIM = 300; // ms between looks at what the axes should show
const GUTTER = 46; // px for the marks of the vertical axis
const LINE = 14.3; // px of one number beside a strip
const TRIMMED = 0.12; // share of an estimate's outermost moments that its axis does not follow: starts, and what other faults throw it to
const BANDS = 2; // with more observers only the first one's band is drawn, or that of the one that is pointed at

export function mountScope(root, app) {
  const scope = new Scope(root, app);
  app.subscribe((state) => [state.plant, state.columns, state.observers, state.faults, state.checks, state.strips, state.noise, state.language, state.presentation],
    () => scope.build());
  app.subscribe((state) => [state.plant, state.selection, state.window, state.session], () => scope.refit());
  app.subscribe((state) => state.language, () => { scope.title.textContent = app.text.scope; });
  app.subscribe((state) => [state.theme, state.presentation], () => scope.restyle());
  app.subscribe((state) => [state.connection, state.alarms, state.log.length], () => {
    scope.still = '';
    app.wake();
  });
  app.subscribe((state) => untold(state).map((one) => `${one.channel} ${one.smallest === null}`).join(), () => scope.showUntold());
  app.onFrame((now) => scope.draw(now));
  app.onTick(() => scope.showValues());
  return scope;
}

class Scope {
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
    const {state, text} = this.app;
    this.strips = stripsOf(state);
    const shown = this.strips.filter((strip) => strip.shown);
    for (const strip of shown) {
      const row = this.rows.get(strip.name) ?? createRow();
      this.rows.set(strip.name, row);
      row.strip = {...strip, ticks: [], tickPlaces: 2};
      this.label(row, text);
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

  label(row, text) {
    const {strip} = row;
    const words = {residual: text.residual, excitation: text.excitation}[strip.kind] ?? text.named(strip.title);
    const [letters, index] = split(strip.symbol);
    const wordy = strip.kind === 'excitation' ? false : letters.length > 1 || index.length > 3;
    const unit = strip.unit ? ` ${strip.unit}` : '';
    const open = h('button', {type: 'button', class: 'open', title: text.openFigure, 'aria-label': `${text.openFigure}: ${words}`,
      onclick: () => openFigure(this.app, strip.name)}, h('svg', {viewBox: '0 0 16 16', width: 13, height: 13, fill: 'none', stroke: 'currentColor',
      'stroke-width': 1.5, 'stroke-linecap': 'round', 'aria-hidden': 'true'}, h('path', {d: 'M9.500 3H13v3.500M13 3L9 7M6.500 13H3V9.500M3 13l4-4'})));
    fill(row.label, h('span', {class: `sign${wordy ? ' wordy' : ''}`}, signOf(strip, this.app.state.plant)), open, h('small', {title: words + unit}, words));
    row.element.style.setProperty('--weight', strip.weight);
    row.element.dataset.kind = strip.kind;
    row.element.dataset.strip = strip.name;
    row.element.classList.toggle('fault-on', strip.kind === 'theta' && this.app.state.faults.some(({subject, active}) => active && subject === strip.subject));
    row.canvas.dataset.name = [symbolic(strip.symbol) && plain(strip.symbol), words].filter(Boolean).join(' ');
    row.canvas.setAttribute('aria-label', row.canvas.dataset.name);
    const own = strip.traces.map((trace) => h('span', {style: `--c:${strip.log && strip.traces.length === 1 ? 'var(--ok)' : trace.colour}`, 'data-label': trace.label}));
    row.values.style.setProperty('--lines', Math.ceil((own.length + (strip.truth ? 1 : 0)) / 2));
    fill(row.values, strip.truth && h('span', {class: 'truth'}), own);
  }

  /** Say which faults the input of the last window does not tell. */
  showUntold() {
    const {state, text} = this.app;
    const lost = untold(state);
    for (const {strip, untold: mark} of this.rows.values()) {
      const one = strip.kind === 'theta' ? lost.find(({channel}) => channel === strip.subject) : undefined;
      mark.hidden = one === undefined;
      mark.textContent = one?.smallest === null ? text.notSeenNow : text.underNoise;
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
    const crowded = [...this.rows.values()].some(({element, values}) => values.childElementCount * LINE * this.colours.size > element.clientHeight);
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

  draw(now) {
    const {app} = this;
    const {state, samples, ghost} = app;
    const moving = app.edge.move(now, samples.now, state.rate || state.speed || 1, state.playing && state.connection === 'live');
    if (this.rows.size === 0 || !this.place) return moving;
    const [t0, t1] = this.span();
    const shown = `${samples.version} ${ghost?.version} ${t0} ${t1}`;
    const gliding = this.aim(now, t0, t1);
    if (shown === this.still && !gliding && !moving) return false;
    this.still = shown;
    const step = niceStep(t1 - t0, Math.max(2, this.place.width / (78 * this.colours.size)));
    const view = {t0, t1, step, samples, ghost, now: samples.now, row: samples.record, faults: state.faults, alarms: state.alarms, bands: this.bands()};
    for (const row of this.rows.values()) {
      if (row.place.height > 0) drawStrip(row.ctx, row.strip, row.place, view, row.range, this.colours);
    }
    drawTimeAxis(this.ctx, this.place, view, this.colours);
    return moving || gliding;
  }

  /** Only this observer's band is drawn while its name is pointed at. */
  point(label) {
    this.pointed = label;
    this.still = '';
    this.app.wake();
  }

  bands() {
    const {observers} = this.app.state;
    if (this.pointed) return new Set([this.pointed]);
    return new Set((observers.length > BANDS ? observers.slice(0, 1) : observers).map(({label}) => label));
  }

  /** Let every axis see what it should; whether one is still gliding. */
  aim(now, t0, t1) {
    const due = this.seen !== this.app.samples.version; // look once more after the last change, too
    const look = now - this.aimed > AIM || (due && this.atOnce);
    if (look) [this.aimed, this.seen] = [now, this.app.samples.version];
    const settled = this.app.samples.rows > 1 && this.app.samples.rows >= this.app.state.row;
    let gliding = false;
    for (const {strip, range, place} of this.rows.values()) {
      if (look) {
        const [low, high] = this.wanted(strip, t0, t1);
        range.aim(low, high, now, this.atOnce);
      }
      gliding = range.move(now) || gliding;
      if (look || gliding) setTicks(strip, range, place.height / this.colours.size);
    }
    if (look && settled) this.atOnce = false;
    return gliding || due;
  }

  /** What a strip should show between two times: all of the truth, and of the estimates all but their outermost moments. */
  wanted(strip, t0, t1) {
    const {samples} = this.app;
    const first = Math.max(0, Math.floor(t0 / samples.record));
    const last = Math.min(samples.rows, Math.ceil(t1 / samples.record) + 1);
    const parts = strip.base ? [strip.base] : [];
    if (last > first) {
      if (strip.truth) parts.push(extent(samples, strip.truth, first, last, 0));
      for (const {column} of strip.traces) parts.push(extent(samples, column, first, last, TRIMMED));
    }
    const found = parts.filter(Boolean);
    if (found.length === 0) return [0, 1];
    let low = Math.min(...found.map(([a]) => a));
    let high = Math.max(...found.map(([, b]) => b));
    if (strip.kind === 'residual') [low, high] = [-Math.max(-low, high), Math.max(-low, high)];
    const least = Math.max(strip.least, 0.02 * Math.max(Math.abs(low), Math.abs(high)), 1e-12);
    const middle = (low + high) / 2;
    return high - low < least ? [middle - least / 2, middle + least / 2] : [low, high];
  }

  /** What stands where there are no curves (yet). */
  showEmpty() {
    const {state, samples, text} = this.app;
    const words = ['ended', 'failed', 'full'].includes(state.connection) ? '' : !state.plant ? text.loading
      : this.rows.size === 0 ? text.noStrips : samples.rows < 2 && !state.playing ? text.nothingYet : '';
    this.empty.hidden = words === '';
    if (this.empty.textContent !== words) this.empty.textContent = words;
  }

  /** The numbers on the right: at the pointer where it is over the curves, else at the right edge. */
  showValues() {
    const {state, samples} = this.app;
    this.showEmpty();
    if (state.playing && !state.selection) this.pointer.refresh();
    const row = Math.min(samples.rows - 1, Math.round((state.cursor ?? state.selection?.[1] ?? samples.now) / samples.record));
    for (const {strip, values, range, canvas} of this.rows.values()) {
      const places = decimals(range.high - range.low);
      const shown = [...(strip.truth ? [{column: strip.truth, label: this.app.text.truth, fallen: null}] : []), ...strip.traces];
      const words = shown.map(({column, fallen}, i) => {
        const value = samples.value(column, row);
        const text = fallen !== null && value !== value ? this.app.text.diverged
          : strip.log ? this.excited(value, strip, shown.length) : fixed(value, places);
        const cell = values.children[i];
        if (cell && cell.textContent !== text) cell.textContent = text;
        if (strip.log) cell?.classList.toggle('warning', [this.app.text.diverged, this.app.text.notExcited].includes(text));
        return `${shown[i].label} ${text}`;
      });
      if (!state.playing) canvas.setAttribute('aria-label', this.app.text.describe(canvas.dataset.name, words.join(', ')));
    }
  }

  excited(value, {threshold}, count) {
    if (value !== value) return '–';
    const {text} = this.app;
    if (threshold === null || count > 1) return (10 ** value).toExponential(1).replace('-', '−');
    return value >= threshold ? text.excited : text.notExcited;
  }
}

/** What a strip is called in mathematics; a channel that is a word has the letters of its badge in the plant. */
function signOf({kind, symbol: name}, plant) {
  if (kind === 'excitation') return h('span', {class: 'math'}, h('i', {}, 'λ'), h('sub', {}, 'min'));
  if (kind === 'residual') return h('span', {class: 'math', style: split(name)[1].length > 5 && 'white-space:normal;font-size:1rem'}, symbol(name), ' − ', symbol(name, true));
  if (kind !== 'theta') return symbol(name);
  const [letters, index] = badges(plant.channels).get(name);
  return h('span', {class: 'math'}, h('i', {}, letters), index && h('sub', {}, index));
}

function createRow() {
  const label = h('div', {class: 'strip-label'});
  const canvas = h('canvas', {role: 'img'});
  const values = h('div', {class: 'strip-values', 'aria-hidden': 'true'});
  const mark = h('span', {class: 'untold', hidden: true});
  return {label, canvas, values, untold: mark, ctx: canvas.getContext('2d'), range: new Range(), element: h('div', {class: 'strip'}, label, h('div', {class: 'strip-plot'}, canvas, mark), values),
    place: {left: 0, width: 0, height: 0, full: 0}};
}

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

/** Two to four marks on a vertical axis, whole powers of ten on a logarithmic one. */
function setTicks(strip, range, height) {
  const span = range.high - range.low;
  if (!(span > 0)) return;
  const step = strip.log ? Math.max(1, Math.round(niceStep(span, height / 30))) : niceStep(span, Math.max(2, height / (height < 80 ? 17 : 23)));
  strip.ticks = marks(range.low, range.high, step);
  strip.tickPlaces = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
}
