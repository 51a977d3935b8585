// Inputs: what the viewer does to the plant. A row for every input, set point and known signal; a slider acts
// immediately. Folded, the rows show their shapes and waves; unfolded they lie over the panels below.

import {childrenOf, fill, h, query} from '../../../common/dom.js';
import {called, plain, split} from '../../../common/names.js';
import {wholeLines} from '../../../widgets/whole-lines.js';
import {heading, link} from '../../../widgets/controls.js';
import {power} from '../../../widgets/number-format.js';
import {createSignalRow} from '../../../widgets/signal/signal-row.js';
import {named, t} from '../../../i18n/words.js';
import {foldsAway} from '../unfolded.js';
import {itemsOf, presentSignal, rangeOf} from './present-signal.js';

/** @import {App} from '../../types.js' */
/** @import {Item} from './present-signal.js' */
/** @import {SignalRow} from '../../../widgets/signal/signal-row.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const panel = new InputsPanel(element, app);
  foldsAway(element, app, panel, () => app.state.presentation);
  app.subscribe(
    (state) => [state.plant, state.language, state.session],
    () => panel.build(),
  );
  app.subscribe(
    (state) => state.presentation,
    (on) => panel.unfold(on), // a tab of its own has room
  );
  app.subscribe(
    (state) => state.spec,
    () => panel.follow(),
  );
  app.subscribe(
    (state) => state.role,
    (role) => panel.enable(role !== 'view'),
  );
  app.subscribe(
    (state) => [state.diagnosis, state.checks],
    () => panel.judge(),
  );
  app.onTick(() => {
    panel.follow();
    panel.judge();
  });
  app.onFrame((now) => panel.draw(now));
}

const FRAME = 50; // ms between two pictures of the waves

class InputsPanel {
  /** @param {HTMLElement} element @param {App} app */
  constructor(element, app) {
    this.element = element;
    this.app = app;
    this.open = false;
    /** @type {{item: Item, row: SignalRow}[]} */
    this.rows = [];
    this.drawn = 0;
    this.list = h('div', {class: 'signals scroll', id: 'signals'});
    this.more = wholeLines(this.list, () => childrenOf(this.list), app);
    this.excitation = h('p', {class: 'excitation'});
    this.summary = h('span', {class: 'inputs-summary'});
    this.note = h('p', {class: 'soft inputs-note'});
    this.toggle = link('', () => this.unfold(!this.open), {'aria-controls': this.list.id});
  }

  /** Make all rows anew, for another plant or in another language. */
  build() {
    const {plant, spec, role} = this.app.state;
    this.rows = [];
    fill(this.list);
    const items = plant && spec ? itemsOf(plant) : [];
    this.element.hidden = items.length === 0;
    if (!spec || items.length === 0) return fill(this.element);
    const recorded = Boolean(spec.truth?.record);
    this.rows = items.map((item) => ({item, row: this.row(item, recorded)}));
    fill(
      this.list,
      this.rows.map(({row}) => row.element),
    );
    this.rows[0].row.unfold(true);
    this.note.textContent = recorded ? t('page.inputs.recorded') : t('page.inputs.note');
    fill(
      this.element,
      heading(t('page.inputs.title'), this.summary, this.toggle),
      this.list,
      this.excitation,
      this.note,
      this.more,
    );
    this.follow();
    this.judge();
    this.enable(role !== 'view');
    return this.unfold(this.open);
  }

  /**
   * @param {Item} item
   * @param {boolean} recorded
   */
  row(item, recorded) {
    const {app} = this;
    const {name, kind, column, unit, description, controller} = item;
    const title = named(description);
    const fixed = recorded
      ? t('page.inputs.fixed.record')
      : controller === null
        ? null
        : t('page.inputs.fixed.controller');
    return createSignalRow({
      name: (title && title.split(/[,;(，；（]/u)[0].trim()) || called(name, app.state.plant),
      kind: t(`page.inputs.kind.${kind}`),
      hint: [title, unit].filter(Boolean).join(', '),
      badge: split(name),
      unit,
      fixed,
      room: () => {
        const {spec, step} = app.state;
        const level = app.latest(column);
        const {low, high} = rangeOf(item, app.range(column, 0, app.samples.now));
        return {low, high, level: Number.isFinite(level) ? level : low, step, horizon: spec?.horizon ?? 100};
      },
      now: () => this.next,
      past: (from, to) => app.window(column, from, to),
      change: (signal) => app.send({type: 'set-signal', name, signal}),
      press: (row) => {
        row.unfold(!(this.open && row.unfolded));
        this.unfold(true);
      },
    });
  }

  /** The time in s of the next row, from which a command acts. */
  get next() {
    const {samples} = this.app;
    return Math.max(0, samples.rows) * samples.record;
  }

  /** Show the signals that are in force. */
  follow() {
    const {spec} = this.app.state;
    if (!spec) return;
    const at = this.next + 1e-3 * this.app.samples.record;
    const recorded = Boolean(spec.truth?.record);
    for (const {item, row} of this.rows)
      row.follow(recorded || item.controller !== null ? null : presentSignal(spec, item, at));
    const parts = this.rows.map(({item, row}) =>
      row.shape ? `${plain(item.name)} ${t(`page.inputs.shape.${row.shape}`)}` : plain(item.name),
    );
    const words = t('page.inputs.summary', {parts});
    if (this.summary.textContent !== words) this.summary.textContent = words;
  }

  /** @param {number} now   ms */
  draw(now) {
    if (now - this.drawn < FRAME && now >= this.drawn) return;
    this.drawn = now;
    for (const {row} of this.rows) row.draw(this.app.samples.now);
  }

  /** @param {boolean} on */
  enable(on) {
    for (const {row} of this.rows) row.disable(!on);
  }

  /** Whether the inputs excite the faults enough: by the observer that says it, else by the detector. */
  judge() {
    const {app} = this;
    const strip = app.strips().find(({kind}) => kind === 'excitation');
    const level = strip ? 10 ** app.latest(strip.traces[0].column) : app.state.diagnosis?.excitation?.level;
    const needed = strip
      ? strip.threshold === null
        ? null
        : 10 ** strip.threshold
      : app.state.diagnosis?.excitation?.needed;
    const known = typeof level === 'number' && Number.isFinite(level);
    this.excitation.hidden = !known || needed === null || needed === undefined;
    if (!known || needed === null || needed === undefined) return;
    const enough = level >= needed;
    const words = t(enough ? 'page.inputs.excited' : 'page.inputs.not-excited', {
      level: power(level),
      needed: power(needed),
    });
    if (this.excitation.textContent !== words) this.excitation.textContent = words;
    this.excitation.classList.toggle('enough', enough);
  }

  /** @param {boolean} on */
  unfold(on) {
    this.open = on;
    this.element.classList.toggle('open', on);
    this.toggle.textContent = on ? t('page.truth.fold') : t('page.inputs.move');
    this.toggle.setAttribute('aria-expanded', String(on));
    if (!on && this.element.contains(document.activeElement) && document.activeElement !== this.toggle)
      query('.link', this.element).focus();
  }
}
