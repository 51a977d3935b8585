// The fields of a signal that are no sliders: points of a table, an expression, a seed, the order of a sequence.

import {h} from '../../common/dom.js';
import {refusal} from '../controls.js';
import {t} from '../../i18n/words.js';
import {asText, pointsOf} from './table-text.js';

/** @import {Child} from '../../types/dom.js' */
/** @import {Signal} from './shapes.js' */

/**
 * @typedef {object} Context
 * @property {string} name        of the input, in words
 * @property {HTMLElement} problem
 * @property {(signal: Signal) => void} change
 */

/** @typedef {{[field: string]: unknown}} Fields */

const ORDERS = Array.from({length: 15}, (_, k) => k + 2);

/**
 * The fields of a signal.
 * @param {Signal} signal
 * @param {Context} context
 * @returns {Child}
 */
export function fieldsOf(signal, context) {
  if (signal.kind === 'table' || signal.kind === 'steps') return tableFields(signal, context);
  if (signal.kind === 'expression') return textField(signal.text, context);
  if (signal.kind === 'noise') return seedField(signal, context);
  if (signal.kind === 'prbs') return [seedField(signal, context), orderField(signal, context)];
  return null;
}

/**
 * The points of a table, or of steps, a line each.
 * @param {Extract<Signal, {kind: 'table' | 'steps'}>} signal
 * @param {Context} context
 */
function tableFields(signal, {name, problem, change}) {
  const steps = signal.kind === 'steps';
  const times = steps ? [Math.min(0, signal.times[0] - 1), ...signal.times] : signal.times;
  const area = h('textarea', {rows: 4, spellcheck: 'false', 'aria-label': t('page.inputs.table.label', {name})});
  area.value = asText({times, values: signal.values});
  area.addEventListener('change', () => {
    const read = pointsOf(area.value);
    invalid(area, 'problem' in read);
    if ('problem' in read) return refusal(problem, {problem: t(read.problem.code, read.problem.args)});
    return change({kind: 'table', ...read, interpolation: steps ? 'hold' : signal.interpolation});
  });
  area.addEventListener('keydown', (event) => event.stopPropagation());
  return [area, h('p', {class: 'soft'}, t('page.inputs.table.hint'))];
}

/** @param {string} text @param {Context} context */
function textField(text, {name, change}) {
  const label = t('page.inputs.expression.label', {name});
  const input = h('input', {type: 'text', class: 'expression', autocomplete: 'off', spellcheck: 'false', value: text});
  input.setAttribute('aria-label', label);
  input.addEventListener('change', () => change({kind: 'expression', text: input.value}));
  return [input, h('p', {class: 'soft'}, t('page.inputs.expression.hint'))];
}

/**
 * @param {Extract<Signal, {kind: 'prbs' | 'noise'}>} signal
 * @param {Context} context
 */
function seedField(signal, {name, change}) {
  const words = t('page.inputs.field.seed');
  const input = h('input', {
    type: 'text',
    inputmode: 'numeric',
    class: 'number',
    autocomplete: 'off',
    value: String(signal.seed),
    'aria-label': t('page.inputs.field-of', {name, field: words}),
    title: t('page.inputs.seed.hint'),
  });
  input.addEventListener('change', () => {
    const value = Number(input.value);
    const right = /^\s*\d+\s*$/.test(input.value) && Number.isSafeInteger(value);
    invalid(input, !right);
    if (right) change({...signal, seed: value});
  });
  return h('div', {class: 'signal-entry'}, h('span', {}, words), input);
}

/** @param {Extract<Signal, {kind: 'prbs'}>} signal @param {Context} context */
function orderField(signal, {name, change}) {
  const words = t('page.inputs.field.order');
  const choice = h(
    'select',
    {'aria-label': t('page.inputs.field-of', {name, field: words}), title: t('page.inputs.order.hint')},
    h('option', {value: ''}, t('page.inputs.order.none')),
    ORDERS.map((n) => h('option', {value: String(n)}, t('page.inputs.order.bits', {n, length: 2 ** n - 1}))),
  );
  choice.value = String(signal.order ?? '');
  choice.addEventListener('change', () =>
    change({...signal, order: choice.value === '' ? null : Number(choice.value)}),
  );
  return h('div', {class: 'signal-entry'}, h('span', {}, words), choice);
}

/** @param {HTMLElement} field @param {boolean} wrong */
function invalid(field, wrong) {
  if (wrong) field.setAttribute('aria-invalid', 'true');
  else field.removeAttribute('aria-invalid');
}
