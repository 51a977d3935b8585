// The scope: strips on one time axis. This file lays them out and draws them; head.js and pointer.js are its controls.

import {context, fill, h} from '../../common/dom.js';
import {niceStep} from './axes.js';
import {drawStrip, palette} from './canvas.js';
import {mountHead} from './head.js';
import {mountPointer} from './pointer.js';
import {createRow, fit, label, labelAll, shorten} from './row.js';
import {coincident} from './twins.js';
import {showValues} from './values.js';
import {unresolved} from '../../diagnosis/fault-size.js';
import {leaving, setTicks, wanted} from './axis-view.js';
import {drawTimeAxis} from './time-axis.js';
import {stripsOf} from '../state/strips.js';
import {say, t} from '../../i18n/words.js';
import {pending, visible} from '../state/visible.js';

/** @import {App, Place, Row, Strip} from '../types.js' */

const COMPARED = 1000; // ms between two looks for curves that coincide
const AIM = 300; // ms between fits of the axes
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
      state.lesson,
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
    (state) => [state.connection, state.alarms, state.log.length, state.band, state.facts?.judged],
    () => {
      scope.still = '';
      app.wake();
    },
  );
  app.subscribe(
    (state) =>
      unresolved(state)
        .map((one) => `${one.channel} ${one.smallest === null}`)
        .join(),
    () => scope.showUnresolved(),
  );
  app.subscribe(
    (state) => [state.cursor, state.looking],
    () => app.wake(),
  ); // the numbers follow while time is paused, too
  app.onFrame((now) => scope.draw(now));
  app.onTick(() => {
    scope.showValues();
    scope.findTwins();
  });
  return scope;
}

export class Scope {
  /** @param {HTMLElement} root @param {App} app */
  constructor(root, app) {
    this.app = app;
    /** @type {Map<string, Row>} */
    this.rows = new Map();
    /** @type {Strip[]} */
    this.strips = [];
    this.colours = palette();
    this.aimed = 0;
    this.compared = 0;
    this.seen = ''; // the rows and times that the axes were last fitted to
    this.atOnce = true;
    this.still = ''; // the rows and times that are drawn
    this.measured = false; // the canvases have the size of their places
    /** @type {string | null} the observer whose name is pointed at */
    this.pointed = null;
    /** @type {Place | null} of the time axis */
    this.place = null;
    this.head = h('div', {class: 'scope-head'});
    this.list = h('div', {class: 'strips'});
    this.axis = h('canvas', {class: 'time-axis', 'aria-hidden': 'true'});
    this.ctx = context(this.axis);
    this.empty = h('p', {class: 'scope-empty', hidden: true});
    this.plots = h('div', {class: 'plots'}, this.list, this.axis);
    this.title = h('h2', {class: 'hidden'});
    fill(root, this.title, this.head, this.plots, this.empty);
    mountHead(this.head, app, this);
    this.pointer = mountPointer(this.plots, app, this);
    new ResizeObserver(() => {
      this.measured = false;
      app.wake();
    }).observe(this.list);
  }

  /** Rebuild the rows after a change of the strips; rows that remain keep their axes. */
  build() {
    const {state} = this.app;
    this.strips = stripsOf(state);
    const shown = this.strips.filter((strip) => strip.shown);
    for (const strip of shown) {
      const drawn = {...strip, ticks: [], labels: [], power: ''};
      /** @type {Row} */
      const row = this.rows.get(strip.name) ?? {...createRow(() => this.showAll(row)), strip: drawn};
      row.strip = drawn;
      this.rows.set(strip.name, row);
      label(row, this.app);
    }
    const wanted = shown.flatMap((strip) => this.rows.get(strip.name)?.element ?? []);
    for (const name of [...this.rows.keys()]) if (!shown.some((strip) => strip.name === name)) this.rows.delete(name);
    if (wanted.length !== this.list.children.length || wanted.some((element, i) => this.list.children[i] !== element)) {
      this.list.replaceChildren(...wanted);
    }
    this.showUnresolved();
    this.measured = false; // in the next frame, when every panel has changed
    this.showEmpty();
    this.aimed = 0;
    this.still = '';
    this.app.wake();
  }

  /** Say which faults the input of the last window does not tell. */
  showUnresolved() {
    const {state} = this.app;
    const lost = unresolved(state);
    for (const {strip, unresolved: mark} of this.rows.values()) {
      if (strip.kind === 'excitation') continue;
      const one = strip.kind === 'theta' ? lost.find(({channel}) => channel === strip.subject) : undefined;
      mark.hidden = one === undefined;
      mark.textContent =
        one?.smallest === null ? t('page.diagnosis.not-identifiable') : t('page.detectability.below-noise');
    }
  }

  /** Fit the axes immediately: the old ranges mean nothing to another plant or another window. */
  refit() {
    this.atOnce = true;
    this.aimed = 0;
    this.still = '';
    this.app.wake();
  }

  restyle() {
    this.colours = palette();
    this.measured = false;
    this.app.wake();
  }

  /** Draw observers dash-dotted whose curves coincide with an earlier one's. */
  findTwins() {
    const {state, samples} = this.app;
    const now = performance.now();
    if (now - this.compared < COMPARED) return;
    this.compared = now;
    const rows = [...this.rows.values()].map(({strip, range, place}) => ({strip, range, height: place.height}));
    const labels = state.observers.map(({label}) => label);
    const twins = coincident(rows, labels, samples, this.span(), state.twins);
    if (twins.join('\n') !== state.twins.join('\n')) this.app.store.dispatch({type: 'twins', labels: twins});
  }

  /** Fit the canvases to their places. */
  measure() {
    this.measured = true;
    const ratio = Math.min(3, devicePixelRatio || 1);
    for (const row of this.rows.values())
      shorten(row, Math.floor(row.element.clientHeight / (LINE * this.colours.size)));
    for (const row of this.rows.values()) fit(row, row.canvas, ratio, GUTTER * this.colours.size);
    const [first] = this.rows.values();
    if (first) {
      const box = first.canvas.getBoundingClientRect();
      const plots = this.plots.getBoundingClientRect();
      this.axis.style.marginLeft = `${box.left - plots.left}px`;
      this.axis.style.width = `${box.width}px`;
      fit(this, this.axis, ratio, GUTTER * this.colours.size);
      if (this.place) this.pointer.measure(box.left - plots.left + this.place.left, this.place.width);
    }
    this.still = '';
  }

  /**
   * The times at the edges.
   * @returns {[number, number]}
   */
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
    if (!this.measured) this.measure();
    const moving = app.edge.move(
      now,
      samples.now,
      state.rate || state.speed || 1,
      state.playing && state.connection === 'live',
    );
    if (this.rows.size === 0 || !this.place) return moving;
    const [t0, t1] = this.span();
    const shown = `${samples.version} ${ghost?.version} ${t0} ${t1}`;
    const {changed, more} = this.aim(now, t0, t1);
    if (shown === this.still && !changed && !moving) return more;
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
      ...visible(state),
      judged: (state.lesson?.diagnosis ?? true) ? (state.facts?.judged ?? null) : null,
      bands: this.bands(),
      pending: pending(state),
    };
    for (const row of this.rows.values()) {
      if (row.place.height > 0) drawStrip(row.ctx, row.strip, row.place, view, row.range, this.colours);
    }
    drawTimeAxis(this.ctx, this.place, view, this.colours);
    return moving || more;
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
    const chosen = [this.pointed, band].find((label) => label !== null && known(label));
    return new Set(chosen ? [chosen] : observers.map(({label}) => label));
  }

  /**
   * Fit every axis to its curves. Returns whether the picture has changed, and whether another frame is needed.
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
    return {changed: look || gliding, more: gliding || due};
  }

  /**
   * Fit one axis, and mark the curves that leave it.
   * @param {Row} row
   * @param {number} t0
   * @param {number} t1
   * @param {number} now
   */
  look(row, t0, t1, now) {
    const {strip, range} = row;
    const {samples} = this.app;
    const [low, high] = wanted(strip, samples, t0, t1, row.whole);
    range.aim(low, high, now, this.atOnce);
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
    const [low, high] = wanted(row.strip, this.app.samples, ...this.span(), whole);
    row.range.show(low, high, performance.now());
    labelAll(row);
    this.aimed = 0;
    this.still = '';
    this.app.wake();
  }

  /** Say why there are no curves (yet). */
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
    const known = row.strip.traces.some(({column}) => Number.isFinite(samples.latest(column)));
    const why = known
      ? null
      : row.strip.traces
          .flatMap(({label}) => state.checks[label] ?? [])
          .find(({name, value}) => name.code === 'check.excitation' && value === null);
    row.unresolved.hidden = !why;
    const words = why ? say(why.text) : '';
    if (row.unresolved.textContent !== words) row.unresolved.textContent = words;
  }
}
