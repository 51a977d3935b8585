// The pointer over the strips: the time under it on all of them, and zooming by drag.

import {fill, h} from '../../common/dom.js';
import {seconds} from '../../widgets/number-format.js';
import {markWords} from './mark-words.js';

/** @import {App, Scope} from '../types.js' */

const DRAG = 6; // px before it counts as one

/**
 * @param {HTMLElement} plots
 * @param {App} app
 * @param {Scope} scope
 */
export const mountPointer = (plots, app, scope) => new Pointer(plots, app, scope);

class Pointer {
  /**
   * @param {HTMLElement} plots
   * @param {App} app
   * @param {Scope} scope
   */
  constructor(plots, app, scope) {
    this.time = h('span', {class: 'cursor-time'});
    this.line = h('div', {class: 'cursor', hidden: true}, this.time);
    this.area = h('div', {class: 'zoom-area', hidden: true});
    this.markTime = h('span', {class: 'cursor-time'});
    this.mark = h('div', {class: 'cursor looked', hidden: true}, this.markTime);
    this.plots = plots;
    this.app = app;
    this.scope = scope;
    this.left = 0;
    this.width = 1;
    this.over = 0;
    /** @type {{from: number, span: [number, number], far: boolean} | null} */
    this.drag = null;
    plots.append(this.line, this.mark, this.area);
    plots.addEventListener('pointermove', (event) => this.move(event));
    plots.addEventListener('pointerdown', (event) => this.press(event));
    plots.addEventListener('pointerup', (event) => this.release(event));
    plots.addEventListener('pointercancel', () => this.end());
    plots.addEventListener('pointerleave', () => this.drag === null && this.hide());
    plots.addEventListener('dblclick', (event) => this.back(event));
    app.subscribe(
      (state) => [state.looking, state.selection, state.record],
      () => this.showLooking(),
    );
  }

  /**
   * A double click on an axis shows all of its strip, one on the curves ends the zoom.
   * @param {MouseEvent} event
   */
  back(event) {
    const row = this.x(event) < 0 ? this.row(event) : undefined;
    if (row && event.target === row.canvas) this.scope.showAll(row);
    else if (this.x(event) >= 0) this.app.act.select(null);
  }

  /**
   * The row of the strip under the pointer.
   * @param {MouseEvent} event
   */
  row({target}) {
    const strip = target instanceof Element ? target.closest('.strip') : null;
    return this.scope.rows.get(strip?.getAttribute('data-strip') ?? '');
  }

  /** The time that is looked back to, over all strips. */
  showLooking() {
    const {looking, record} = this.app.state;
    this.mark.hidden = looking === null;
    if (looking === null) return;
    const [t0, t1] = this.scope.span();
    this.mark.style.transform = `translateX(${this.left + this.clamped(((looking - t0) / (t1 - t0)) * this.width)}px)`;
    fill(this.markTime, `${seconds(looking, record >= 1 ? 1 : 0.1)} s`);
  }

  /**
   * Where the plot areas begin, and how wide they are, in the list's own pixels.
   * @param {number} from
   * @param {number} wide
   */
  measure(from, wide) {
    this.left = from;
    this.width = Math.max(1, wide);
    this.showLooking();
  }

  /** The time under a resting pointer while the curves move on below it. */
  refresh() {
    if (!this.line.hidden && this.drag === null) this.show(this.over);
  }

  /** @param {MouseEvent} event */
  x(event) {
    return event.clientX - this.plots.getBoundingClientRect().left - this.left;
  }

  /** @param {number} x */
  clamped(x) {
    return Math.min(this.width, Math.max(0, x));
  }

  /** @param {number} x @param {[number, number]} [span] */
  timeAt(x, [t0, t1] = this.scope.span()) {
    return t0 + (this.clamped(x) / this.width) * (t1 - t0);
  }

  /** @param {number} x */
  show(x) {
    const inside = x >= -2 && x <= this.width + 2;
    this.over = x;
    this.line.hidden = !inside;
    this.app.cursor(inside ? Math.max(0, Math.min(this.timeAt(x), this.app.samples.now)) : null);
    if (!inside) return;
    const [t0, t1] = this.scope.span();
    this.line.style.transform = `translateX(${this.left + this.clamped(x)}px)`;
    fill(this.time, `${seconds(this.timeAt(x), (t1 - t0) / 500)} s`);
  }

  hide() {
    this.line.hidden = true;
    this.app.cursor(null);
  }

  /** @param {PointerEvent} event */
  press(event) {
    const x = this.x(event);
    if (
      event.button !== 0 ||
      x < 0 ||
      x > this.width ||
      event.pointerType === 'touch' ||
      (event.target instanceof Element && event.target.closest('button'))
    )
      return;
    this.drag = {from: x, span: this.scope.span(), far: false}; // the window as it was: it may move on meanwhile
    this.plots.setPointerCapture(event.pointerId);
  }

  /** @param {PointerEvent} event */
  move(event) {
    const x = this.x(event);
    this.show(x);
    this.say(event, x);
    if (this.drag === null) return;
    this.drag.far ||= Math.abs(x - this.drag.from) > DRAG;
    if (!this.drag.far) return;
    const [a, b] = [this.clamped(Math.min(x, this.drag.from)), this.clamped(Math.max(x, this.drag.from))];
    this.area.hidden = false;
    Object.assign(this.area.style, {left: `${this.left + a}px`, width: `${b - a}px`});
  }

  /**
   * Show the meaning of the mark under the pointer as a hint.
   * @param {PointerEvent} event
   * @param {number} x
   */
  say(event, x) {
    const row = this.row(event);
    if (!row || event.target !== row.canvas) return;
    const words = x >= 0 ? markWords(row, x, event.offsetY, (at) => this.timeAt(at), this.app) : '';
    if (row.canvas.title !== words) row.canvas.title = words;
  }

  /** @param {PointerEvent} event */
  release(event) {
    if (this.drag === null) return;
    const {from, span, far} = this.drag;
    const x = this.x(event);
    this.end();
    if (far) this.app.act.select(this.timeAt(Math.min(x, from), span), this.timeAt(Math.max(x, from), span));
  }

  end() {
    this.drag = null;
    this.area.hidden = true;
  }
}
