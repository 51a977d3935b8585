// A place over a strip on which the student draws, by pointer or keyboard, how a quantity will go.

import {h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import {Sketched} from '../types.js' */
/** @import {Lesson} from './lesson.js' */

const STEPS = 40; // presses of a key from the least value to the greatest

export class SketchPad {
  /** @param {Lesson} lesson */
  constructor(lesson) {
    this.lesson = lesson;
    /** @type {number | null} the place that the pointer was at last, while it draws */
    this.drawing = null;
    this.element = h('div', {
      class: 'sketch-pad',
      role: 'slider',
      tabindex: 0,
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
      onpointerdown: (/** @type {PointerEvent} */ event) => this.press(event),
      onpointermove: (/** @type {PointerEvent} */ event) => this.drawing !== null && this.draw(event),
      onpointerup: () => this.release(),
      onpointercancel: () => this.release(),
      onfocus: () => this.say(),
    });
    lesson.app.subscribe(
      (state) => [
        state.lesson,
        state.plant,
        state.columns,
        state.observers,
        state.strips,
        state.language,
        state.presentation,
      ],
      () => this.place(),
    );
  }

  get sketch() {
    return this.lesson.app.state.lesson?.sketch ?? null;
  }

  /** Lie over the strip as long as it can be drawn on. */
  place() {
    const {sketch} = this;
    const row = sketch && sketch.at !== null ? this.lesson.app.scope.rows.get(sketch.strip) : undefined;
    if (!row || this.lesson.view.phase !== 'before') return this.element.remove();
    if (this.element.parentElement !== row.plot) row.plot.append(this.element);
    this.element.setAttribute('aria-label', t('page.lesson.sketch.label', {strip: row.canvas.dataset.name ?? ''}));
    this.say();
  }

  /** The value that the keys move, for a screen reader. */
  say() {
    const {sketch} = this;
    if (!sketch || sketch.at === null) return;
    const value = sketch.values[sketch.at];
    const at = (sketch.at / (sketch.values.length - 1)) * (sketch.until - sketch.from);
    this.element.setAttribute('aria-valuemin', String(sketch.low));
    this.element.setAttribute('aria-valuemax', String(sketch.high));
    this.element.setAttribute('aria-valuenow', String(value));
    this.element.setAttribute(
      'aria-valuetext',
      t('page.lesson.sketch.value', {
        t: String(Number(at.toPrecision(3))),
        value: String(Number(value.toPrecision(3))),
        unit: this.lesson.app.scope.rows.get(sketch.strip)?.strip.unit ?? '',
      }),
    );
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const {sketch} = this;
    if (!sketch || sketch.at === null || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = ((sketch.high - sketch.low) / STEPS) * (event.shiftKey ? 4 : 1);
    const last = sketch.values.length - 1;
    /** @type {{[key: string]: () => void}} */
    const acts = {
      ArrowLeft: () => this.set(sketch.values, Math.max(0, (sketch.at ?? 0) - 1)),
      ArrowRight: () => this.set(sketch.values, Math.min(last, (sketch.at ?? 0) + 1)),
      Home: () => this.set(sketch.values, 0),
      End: () => this.set(sketch.values, last),
      ArrowUp: () => this.bend(sketch, step),
      ArrowDown: () => this.bend(sketch, -step),
    };
    if (!acts[event.key]) return; // Enter runs the step
    event.preventDefault();
    event.stopPropagation();
    acts[event.key]();
  }

  /** @param {Sketched} sketch @param {number} by */
  bend({values, at, low, high}, by) {
    const changed = values.map((value, place) => (place === at ? Math.min(high, Math.max(low, value + by)) : value));
    this.set(changed, at ?? 0, true);
  }

  /** @param {readonly number[]} values @param {number} at @param {boolean} [drawn] */
  set(values, at, drawn = false) {
    this.lesson.sketched([...values], at, drawn);
  }

  /** @param {PointerEvent} event */
  press(event) {
    if (event.button !== 0) return;
    event.stopPropagation(); // of the strip: it would zoom
    this.element.setPointerCapture(event.pointerId);
    this.element.focus({preventScroll: true});
    this.drawing = this.nearest(event);
    this.draw(event);
    event.preventDefault();
  }

  release() {
    this.drawing = null;
  }

  /** The values between the place where the pointer was and that where it is become what it points at. */
  draw(/** @type {PointerEvent} */ event) {
    const {sketch} = this;
    const row = sketch && this.lesson.app.scope.rows.get(sketch.strip);
    if (!sketch || !row) return;
    event.stopPropagation();
    const box = row.canvas.getBoundingClientRect();
    const share = (box.bottom - event.clientY) / Math.max(1, box.height);
    const value = row.range.low + share * (row.range.high - row.range.low);
    const clamped = Math.min(sketch.high, Math.max(sketch.low, value));
    const now = this.nearest(event);
    const before = this.drawing ?? now;
    const [a, b] = [Math.min(before, now), Math.max(before, now)];
    const values = sketch.values.map((old, place) =>
      place === now || (place > a && place < b) ? Number(clamped.toPrecision(4)) : old,
    );
    this.drawing = now;
    this.set(values, now, true);
  }

  /** The place of the value nearest to the pointer. @param {PointerEvent} event */
  nearest(event) {
    const {sketch} = this;
    const {scope} = this.lesson.app;
    const row = sketch && scope.rows.get(sketch.strip);
    if (!sketch || !row) return 0;
    const [t0, t1] = scope.span();
    const x = event.clientX - row.canvas.getBoundingClientRect().left - row.place.left;
    const time = t0 + (x / Math.max(1, row.place.width)) * (t1 - t0);
    const last = sketch.values.length - 1;
    const place = Math.round(((time - sketch.from) / (sketch.until - sketch.from)) * last);
    return Math.min(last, Math.max(0, place));
  }
}
