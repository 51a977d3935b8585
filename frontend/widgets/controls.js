// Small parts that the panels share: headings, badges, chips, a slider with its number, numbers that keep their width.

import {h, fill, number} from '../common/dom.js';
import {ENDS, digitsOf, position, value as valueAt} from './slider-scale.js';
import {asSentence, refusalWords, t} from '../i18n/words.js';

/** @import {Scale} from './slider-scale.js' */
/** @import {App} from '../live/types.js' */
/** @import {Child, Properties} from '../types/dom.js' */

/**
 * The heading of a panel, with a link at its right end.
 * @param {Child} title
 * @param {...Child} right
 */
export const heading = (title, ...right) => h('div', {class: 'heading'}, h('h2', {}, title), ...right);

/**
 * A mark for a heading: while the scope looks back, that the panel shows the present.
 * @param {App} app
 */
export function asOfNow(app) {
  const tag = h('span', {class: 'as-of-now', hidden: true});
  app.onTick((now) => {
    const {looking, selection, record, spec} = app.state;
    tag.hidden = (looking ?? selection?.[1] ?? Infinity) > now - 1.5 * record;
    const words = tag.hidden ? '' : t('page.diagnosis.now', {t: seconds(now, spec?.horizon)});
    if (tag.textContent !== words) tag.textContent = words;
  });
  return tag;
}

/**
 * A button that looks like a link.
 * @param {Child} words
 * @param {() => void} act
 * @param {Properties} [more]
 */
export const link = (words, act, more = {}) =>
  h('button', {type: 'button', class: 'link', onclick: act, ...more}, words);

/**
 * The round badge of a channel (or square one of an output), amber while its fault is active.
 * @param {[letters: string, index: string]} sign
 * @param {{square?: boolean, lit?: boolean}} [look]
 */
export function badge([letters, whole], {square = false, lit = false} = {}) {
  const index = whole.slice(0, 2);
  const long = letters.length + index.length > 2;
  return h(
    'span',
    {class: `badge${square ? ' square' : ''}${long ? ' long' : ''}${lit ? ' lit' : ''}`, 'aria-hidden': 'true'},
    h('i', {}, letters),
    index && h('sub', {}, index),
  );
}

/**
 * The colour of an observer, as a stroke like its curve.
 * @param {string} colour
 * @param {boolean} [dashed]
 */
export const chip = (colour, dashed = false) =>
  h('span', {class: dashed ? 'chip dashed' : 'chip', style: `--c:${colour}`});

/**
 * A number with as many decimals as numbers of its scale need for four digits, so that it keeps its width while it
 * changes.
 * @param {number} value
 * @param {number} [scale]
 * @param {number} [digits]
 */
export function steady(value, scale = value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0 && scale === 0) return '0';
  const size = Math.abs(scale) || 1;
  if (size >= 1e5 || size < 1e-4) return number(value, digits);
  const decimals = Math.min(8, Math.max(0, digits - 1 - Math.floor(Math.log10(size))));
  return value.toFixed(decimals).replace('-', '−');
}

/**
 * A time in s, with as many decimals as a session of this length wants.
 * @param {number} t
 * @param {number} [horizon]
 */
export const seconds = (t, horizon = 100) =>
  `${horizon < 0.1 ? number(t, 4) : t.toFixed(horizon >= 1000 ? 0 : horizon >= 20 ? 1 : horizon >= 1 ? 2 : 4)}\u202fs`;

/**
 * How long something took: 0.4 s, 12 s.
 * @param {number} time
 */
export const took = (time) => `${time < 10 ? time.toFixed(time < 1 ? 2 : 1) : time.toFixed(0)}\u202fs`;

/**
 * A number as one types it, in few characters.
 * @param {number} value
 * @param {number} digits
 */
const typed = (value, digits) =>
  value !== 0 && Math.abs(value) < 1e-3
    ? value.toExponential(digits - 1).replace(/\.?0*e/, 'e')
    : String(Number(value.toPrecision(digits)));

/**
 * A slider and a field for the same number.
 * @param {{name: string, scale: Scale, value: number, change: (value: number, done: boolean) => void,
 *   low?: number, high?: number, positive?: boolean}} options
 */
export function slider({name, scale, value, change, low = -Infinity, high = Infinity, positive = false}) {
  const range = h('input', {type: 'range', min: 0, max: ENDS, step: 5, 'aria-label': name});
  const field = h('input', {
    type: 'text',
    inputmode: 'decimal',
    class: 'number',
    'aria-label': name,
    autocomplete: 'off',
    spellcheck: 'false',
  });
  let present = value;
  let typing = false;
  /** @type {number | null} the value that came from elsewhere during typing */
  let waiting = null;
  /** @param {number} next */
  const show = (next) => {
    [present, typing, waiting] = [next, false, null];
    range.value = String(position(scale, next));
    range.setAttribute('aria-valuetext', number(next));
    field.value = typed(next, digitsOf(scale));
    field.removeAttribute('aria-invalid');
  };
  /** @param {boolean} done */
  const slide = (done) => {
    show(valueAt(scale, Number(range.value)));
    change(present, done);
  };
  range.addEventListener('input', () => slide(false));
  range.addEventListener('change', () => slide(true));
  field.addEventListener('input', () => {
    typing = true;
  });
  field.addEventListener('blur', () => {
    if (waiting !== null) show(waiting);
  });
  field.addEventListener('change', () => {
    const read = Number(field.value.trim().replace(',', '.').replace('−', '-'));
    if (field.value.trim() === '' || !Number.isFinite(read) || read < low || read > high || (positive && read <= 0))
      return field.setAttribute('aria-invalid', 'true');
    show(read);
    return change(present, true);
  });
  show(value);
  return {
    range,
    field,
    show,
    get value() {
      return present;
    },
    /**
     * Show a value that a command has set, unless one is typing or dragging.
     * @param {number} next
     */
    follow(next) {
      if (typing || range.matches(':active')) waiting = next;
      else show(next);
    },
    /** @param {boolean} off */
    disable(off) {
      range.disabled = off;
      field.disabled = off;
    },
  };
}

/**
 * Send at most one command at a time, and at most one every `pause` ms; the newest wins.
 * @template {unknown[]} A
 * @param {(...args: A) => Promise<unknown>} send
 * @param {number} [pause]
 * @returns {(...args: A) => void}
 */
export function throttled(send, pause = 200) {
  /** @type {A | null} */
  let waiting = null;
  let busy = false;
  const next = async () => {
    if (busy || waiting === null) return;
    const mine = waiting;
    waiting = null;
    busy = true;
    const began = performance.now();
    try {
      await send(...mine);
    } finally {
      setTimeout(
        () => {
          busy = false;
          next();
        },
        Math.max(0, pause - (performance.now() - began)),
      );
    }
  };
  return (...what) => {
    waiting = what;
    next();
  };
}

/**
 * A refusal in place: the problem and the remedy.
 * @param {HTMLElement} element
 * @param {unknown} error   null: none
 */
export function refusal(element, error) {
  if (!error) return fill(element);
  const {problem, remedy} = refusalWords(error);
  return fill(
    element,
    h('span', {}, asSentence(problem), ' '),
    remedy && h('span', {class: 'remedy'}, t('page.text.remedy', {remedy: asSentence(remedy)})),
  );
}
