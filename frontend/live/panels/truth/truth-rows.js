// The rows of the panel: a number with its slider, or a text; each with the refusal of its value.

import {fill, h, number} from '../../../common/dom.js';
import {refusal, slider} from '../../../widgets/controls.js';
import {icon} from '../../../widgets/svg.js';
import {t} from '../../../i18n/words.js';

/** @import {Child} from '../../../types/dom.js' */
/** @import {Scale} from '../../../widgets/slider-scale.js' */
/** @import {Truth} from './truth-edits.js' */

/**
 * @typedef {object} Row
 * @property {string} path                      the element of the truth that it shows
 * @property {HTMLElement} element
 * @property {(truth: Truth) => void} follow    show what the truth has, unless the row holds a refused value
 * @property {(error: unknown) => void} fail    show a refusal; null: none
 * @property {(off: boolean) => void} disable
 * @property {() => void} focus
 */

const ROOM = 9; // characters
let rows = 0;

/**
 * A place for a refusal, and the attributes of the field that it belongs to.
 * @param {HTMLInputElement} field
 */
function refusable(field) {
  rows += 1;
  const problem = h('p', {class: 'refused', role: 'alert', id: `truth-problem-${rows}`});
  let failed = false;
  return {
    problem,
    get failed() {
      return failed;
    },
    /** @param {unknown} error */
    fail(error) {
      failed = Boolean(error);
      refusal(problem, error);
      if (failed) {
        field.setAttribute('aria-invalid', 'true');
        field.setAttribute('aria-describedby', problem.id);
      } else for (const name of ['aria-invalid', 'aria-describedby']) field.removeAttribute(name);
    },
  };
}

/**
 * Why a typed number is not accepted.
 * @param {string} typed
 * @param {number} [low]
 * @param {number} [high]
 */
function outside(typed, low = -Infinity, high = Infinity) {
  const value = Number(typed.trim().replace(',', '.').replace('−', '-'));
  if (typed.trim() === '' || !Number.isFinite(value)) return {code: 'page.truth.not-a-number', args: {}};
  return value < low
    ? {code: 'page.truth.too-small', args: {low: number(low)}}
    : {code: 'page.truth.too-large', args: {high: number(high)}};
}

/**
 * A button that takes one difference back; it keeps its place when nothing differs.
 * @param {string} name
 * @param {() => void} act
 */
const undoOf = (name, act) =>
  h(
    'button',
    {type: 'button', class: 'plain undo control-only', 'aria-label': t('page.truth.undo', {name}), onclick: act},
    icon('back', 12),
  );

/**
 * A number with its slider.
 * @param {object} options
 * @param {string} options.path
 * @param {Child} options.label
 * @param {number} [options.room]      characters of the label beside the slider; a longer one is above it
 * @param {string} options.name        in full, for readers of screens
 * @param {string} [options.hint]
 * @param {string} options.unit
 * @param {Scale} options.scale
 * @param {number} [options.low]
 * @param {number} [options.high]
 * @param {(truth: Truth) => number} options.value
 * @param {(truth: Truth) => boolean} options.differs
 * @param {(value: number) => void} options.change
 * @param {(value: number) => number} [options.snap]   of a value that was slid to
 * @param {() => void} options.back                    as in the model again
 * @param {(truth: Truth, scale: Scale) => void} [options.fit]   adapt the scale
 * @returns {Row}
 */
export function numberRow(options) {
  const {path, label, name, hint, unit, scale, low, high, value, differs, change} = options;
  const {room = ROOM, snap = (one) => one} = options;
  const control = slider({
    name,
    scale,
    value: scale.min,
    low,
    high,
    change: (next) => {
      mark.fail(null);
      const sliding = document.activeElement === control.range || control.range.matches(':active');
      change(sliding && next !== 0 ? snap(next) : next);
    },
  });
  const mark = refusable(control.field);
  control.field.addEventListener('change', () => {
    if (control.field.matches('[aria-invalid]')) mark.fail(outside(control.field.value, low, high));
  });
  const undo = undoOf(name, () => {
    mark.fail(null);
    options.back();
  });
  const caption = h('span', {class: 'label'}, label);
  const element = h(
    'div',
    {
      class: `truth-row${caption.textContent.length > room ? ' wordy' : ''}`,
      role: 'group',
      'aria-label': name,
      title: hint,
    },
    caption,
    control.range,
    control.field,
    h('span', {class: 'unit', title: unit}, unit),
    undo,
    mark.problem,
  );
  return {
    path,
    element,
    follow(truth) {
      options.fit?.(truth, scale);
      element.classList.toggle('differs', differs(truth));
      undo.disabled = control.field.disabled || !(differs(truth) || mark.failed);
      if (!mark.failed) control.follow(value(truth));
    },
    fail: mark.fail,
    disable: control.disable,
    focus: () => control.field.focus(),
  };
}

/**
 * A text.
 * @param {object} options
 * @param {string} options.path
 * @param {Child} options.label
 * @param {string} options.name
 * @param {string} [options.hint]
 * @param {string} [options.placeholder]
 * @param {string} [options.kind]      a class of its own
 * @param {(truth: Truth) => string} options.value
 * @param {(text: string) => unknown} options.change   an error that it returns is shown
 * @returns {Row}
 */
export function textRow({path, label, name, hint, placeholder, kind = '', value, change}) {
  const field = h('input', {
    type: 'text',
    'aria-label': name,
    placeholder,
    autocomplete: 'off',
    autocapitalize: 'off',
    spellcheck: 'false',
  });
  const mark = refusable(field);
  let shown = '';
  field.addEventListener('change', () => {
    mark.fail(null);
    mark.fail(change(field.value));
  });
  const element = h(
    'div',
    {class: `truth-text ${kind}`, title: hint},
    h('span', {class: 'label', 'aria-hidden': 'true'}, label),
    field,
    mark.problem,
  );
  return {
    path,
    element,
    follow(truth) {
      const next = value(truth);
      element.classList.toggle('differs', next !== '');
      if (mark.failed || (document.activeElement === field && next === shown)) return;
      shown = next;
      if (field.value !== next) field.value = next;
    },
    fail: mark.fail,
    disable(off) {
      field.disabled = off;
    },
    focus: () => field.focus(),
  };
}

/**
 * Rows under a heading that folds them away; it says how many of them differ.
 * @param {string} title
 * @param {Child[]} children
 * @param {(truth: Truth) => number} count
 */
export function section(title, children, count) {
  const tally = h('span', {class: 'tally'});
  const element = h('details', {class: 'fold truth-section'}, h('summary', {}, title, tally), children);
  return {
    element,
    /** @param {Truth} truth */
    follow(truth) {
      const many = count(truth);
      fill(tally, many > 0 && t('page.truth.differ', {n: many}));
    },
  };
}
