// One input of a plant, a reference or a known signal: its shape, its wave, and the sliders of the shape. Every change
// acts immediately. Live and other pages say what it is about and where changes go.

import {fill, h} from '../../common/dom.js';
import {badge, refusal, slider, throttled} from '../controls.js';
import {logarithmic} from '../slider-scale.js';
import {t} from '../../i18n/words.js';
import {drawing, tableOf} from './drawing.js';
import {SHAPES, begun, sliders} from './shapes.js';
import {fieldsOf} from './signal-fields.js';
import {wave} from './wave.js';

/** @import {Room, Signal, Slider} from './shapes.js' */
/** @import {Curve} from './wave.js' */

/**
 * What a row is about.
 * @typedef {object} About
 * @property {string} name      its name on the page, in words
 * @property {string} kind      input, set point, known signal
 * @property {string} hint
 * @property {[string, string]} badge
 * @property {string} unit
 * @property {string | null} fixed   why it cannot be moved; null: it can
 * @property {() => Room} room
 * @property {() => number} now      the time in s from which a change acts
 * @property {(from: number, to: number) => Curve} past
 * @property {(signal: Signal) => Promise<unknown>} change   rejects with a refusal
 * @property {(row: SignalRow) => void} [press]   in place of folding and unfolding the row when its name is pressed
 */

/** @param {About} about */
export function createSignalRow(about) {
  return new SignalRow(about);
}

/** @param {Signal | null} one @param {Signal | null} other */
const equal = (one, other) => JSON.stringify(one) === JSON.stringify(other);

export class SignalRow {
  /** @type {Signal | null} in force, or on its way to the server */
  #signal = null;
  /** @type {Signal | null} in force, as the server says */
  #known = null;
  #waiting = false; // for the server's answer to the newest signal
  #off = false;
  /** @type {ReturnType<typeof drawing> | null} while a curve is drawn by hand */
  #hand = null;
  #length = 0; // s, of the curve that is drawn
  #built = ''; // what the controls are for
  /** @type {Map<string, ReturnType<typeof slider>>} */
  #controls = new Map();

  /** @param {About} about */
  constructor(about) {
    this.about = about;
    this.menu = h(
      'select',
      {class: 'shape', 'aria-label': t('page.inputs.shape-of', {name: about.name})},
      SHAPES.map((shape) => h('option', {value: shape}, t(`page.inputs.shape.${shape}`))),
    );
    this.picture = wave({
      name: t('page.inputs.wave-of', {name: about.name}),
      past: about.past,
      horizon: () => about.room().horizon,
    });
    const press = () => (about.press ? about.press(this) : this.unfold(!this.unfolded));
    this.title =
      about.fixed === null
        ? h('button', {type: 'button', class: 'signal-name', onclick: press}, h('b', {}, about.name))
        : h('b', {}, about.name);
    this.fields = h('div', {class: 'signal-fields'});
    this.problem = h('p', {class: 'refused', role: 'alert'});
    this.element = h(
      'div',
      {class: 'signal', role: 'group', 'aria-label': about.name},
      badge(about.badge, {square: true}),
      h('div', {class: 'name', title: about.hint}, this.title, ' ', h('span', {class: 'kind'}, about.kind)),
      about.fixed === null ? this.menu : h('span', {class: 'fixed'}, about.fixed),
      this.picture.element,
      about.fixed === null && this.fields,
      this.problem,
    );
    this.menu.addEventListener('change', () => this.#choose(this.menu.value));
    this.unfold(false);
    this.send = throttled((/** @type {Signal} */ wanted) => this.#send(wanted), 150);
  }

  /**
   * Show the signal that is in force (null: it is not known), unless a newer one is on its way.
   * @param {Signal | null} present
   */
  follow(present) {
    this.#known = present;
    if (this.#waiting || equal(present, this.#signal)) return;
    this.#signal = present;
    this.#show();
  }

  /** Whether the sliders are shown. */
  get unfolded() {
    return this.element.classList.contains('unfolded');
  }

  /** @param {boolean} on */
  unfold(on) {
    if (this.about.fixed !== null) return;
    this.element.classList.toggle('unfolded', on);
    this.title.setAttribute('aria-expanded', String(on));
  }

  /** The shape that the row shows; null: it is not known. */
  get shape() {
    return this.#hand ? 'drawn' : (this.#signal?.kind ?? null);
  }

  /** @param {number} now */
  draw(now) {
    this.picture.draw(now);
  }

  /** @param {boolean} off */
  disable(off) {
    this.#off = off;
    this.menu.disabled = off;
    for (const control of this.#controls.values()) control.disable(off);
    for (const one of this.fields.querySelectorAll('textarea, .expression, .signal-entry :is(input, select)'))
      one.toggleAttribute('disabled', off);
    this.#hand?.disable(off);
  }

  /** @param {Signal} wanted */
  async #send(wanted) {
    /** @type {unknown} */
    let refused = null;
    try {
      await this.about.change(wanted);
    } catch (error) {
      refused = error;
    }
    if (this.#signal !== wanted) return; // a newer one is on its way
    this.#waiting = false;
    refusal(this.problem, refused);
    if (refused === null) return;
    this.#built = ''; // fields show what is in force
    this.#hand = null;
    this.#signal = this.#known;
    this.#show();
  }

  /** @param {Signal} wanted */
  #change(wanted) {
    this.#signal = wanted;
    this.#waiting = true;
    this.send(wanted);
    this.#show();
  }

  /** @param {string} shape */
  #choose(shape) {
    refusal(this.problem, null);
    this.#hand = null;
    if (this.about.press && !this.unfolded) this.about.press(this);
    else this.unfold(true);
    if (shape === 'drawn') this.#draw();
    else if (this.#signal) this.#change(begun(shape, this.#signal, this.about.room(), this.about.now()));
  }

  /** Offer a place to draw on; nothing acts before something is drawn. */
  #draw() {
    const {name, unit, room, now} = this.about;
    this.#length ||= room().horizon / 10;
    const hand = drawing({
      name,
      unit,
      room,
      length: () => this.#length,
      level: room().level,
      done: () => this.#change(tableOf(hand.values, now(), this.#length)),
    });
    this.#hand = hand;
    this.#show();
    hand.element.focus({preventScroll: true});
  }

  /** Show the signal: its shape, its wave, its sliders, which are made anew for another shape. */
  #show() {
    const {about} = this;
    const signal = this.#signal;
    this.picture.show(signal, about.now());
    if (signal === null || about.fixed !== null) return;
    const all = this.#hand ? [] : sliders(signal, about.room());
    const shape = this.#hand ? 'drawn' : signal.kind;
    const built = [shape, ...all.map(({name}) => name)].join();
    this.menu.value = shape;
    if (built !== this.#built) {
      this.#controls.clear();
      const rest = this.#hand
        ? this.#handFields(this.#hand)
        : all.length && signal.kind === 'steps'
          ? null
          : this.#more(signal);
      fill(
        this.fields,
        all.map((one) => this.#slider(one)),
        rest,
      );
      this.#built = built;
    }
    for (const one of all) this.#controls.get(one.name)?.follow(one.value);
    this.disable(this.#off);
  }

  /** @param {Signal} signal */
  #more(signal) {
    const change = (/** @type {Signal} */ wanted) => this.#change({...this.#signal, ...wanted});
    return fieldsOf(signal, {name: this.about.name, problem: this.problem, change});
  }

  /** @param {Slider} one */
  #slider(one) {
    const {unit: own, room, now} = this.about;
    const unit = {own, 'own/s': own && `${own}/s`, s: 's', Hz: 'Hz', '': ''}[one.unit];
    return this.#line(one.name, one, unit, (value) => {
      const present = this.#signal && sliders(this.#signal, room()).find(({name}) => name === one.name);
      if (present) this.#change(present.change(one.whole ? Math.round(value) : value, now()));
    });
  }

  /**
   * @param {string} field
   * @param {Pick<Slider, 'scale' | 'value' | 'positive'>} values
   * @param {string} unit
   * @param {(value: number) => void} change
   */
  #line(field, values, unit, change) {
    const words = t(`page.inputs.field.${field}`);
    const control = slider({...values, name: t('page.inputs.field-of', {name: this.about.name, field: words}), change});
    control.field.title = [words, unit].filter(Boolean).join(', ');
    this.#controls.set(field, control);
    return h('div', {class: 'signal-slider'}, h('span', {}, words), control.range, control.field, h('small', {}, unit));
  }

  /** @param {ReturnType<typeof drawing>} hand */
  #handFields(hand) {
    const {horizon} = this.about.room();
    const values = {scale: logarithmic(horizon / 1000, horizon), value: this.#length, positive: true};
    const length = this.#line('length', values, 's', (value) => {
      this.#length = value;
    });
    return [hand.element, length, h('p', {class: 'soft'}, t('page.inputs.draw.hint'))];
  }
}
