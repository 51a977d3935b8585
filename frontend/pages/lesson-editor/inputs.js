// Fields of the editor: words in one language, numbers, choices. A change is kept at once.

import {h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */

/** @typedef {{language: 'en' | 'zh', changed: () => void, rebuild: () => void}} Form */

/**
 * A row: its name, and what can be filled in.
 * @param {string} name
 * @param {...import('../../types/dom.js').Child} controls
 */
export const row = (name, ...controls) =>
  h('div', {class: 'editor-row'}, h('span', {class: 'soft'}, name), h('div', {class: 'editor-fields'}, ...controls));

/**
 * Words in the language that is being written; those of the other one are shown where there are none yet.
 * @template {PropertyKey} K
 * @param {Form} form
 * @param {{[key in K]?: service.Words | null}} target   what has the words, under `key`
 * @param {K} key
 * @param {string} name
 * @param {boolean} [long]
 */
export function words(form, target, key, name, long = false) {
  const {language} = form;
  const now = () => (target[key] ??= {en: '', zh: ''});
  const other = now()[language === 'en' ? 'zh' : 'en'] ?? '';
  /** @type {HTMLInputElement | HTMLTextAreaElement} */
  const field = h(long ? 'textarea' : 'input', {
    ...(long ? {rows: 2} : {type: 'text'}),
    'aria-label': name,
    placeholder: other,
    maxlength: 2000,
    lang: language,
    oninput: () => {
      target[key] = {...now(), [language]: field.value};
      form.changed();
    },
  });
  field.value = now()[language] ?? '';
  return field;
}

/**
 * @param {string} name
 * @param {number | null | undefined} value
 * @param {(value: number | null) => void} change
 */
export function numeral(name, value, change) {
  /** @type {HTMLInputElement} */
  const field = h('input', {
    type: 'number',
    step: 'any',
    class: 'numeral',
    'aria-label': name,
    oninput: () => change(field.value === '' || Number.isNaN(field.valueAsNumber) ? null : field.valueAsNumber),
  });
  field.value = value === null || value === undefined ? '' : String(value);
  return field;
}

/**
 * @template {string} V
 * @param {string} name
 * @param {readonly (readonly [V, string])[]} options   value and words
 * @param {NoInfer<V>} value
 * @param {(value: V) => void} change
 */
export function choice(name, options, value, change) {
  /** @type {HTMLSelectElement} */
  const field = h(
    'select',
    {'aria-label': name, onchange: () => change(/** @type {V} */ (field.value))},
    options.map(([one, shown]) => h('option', {value: one}, shown)),
  );
  field.value = value;
  return field;
}

/** Options that are shown by their own names. @param {readonly string[]} names @returns {[string, string][]} */
export const byName = (names) => names.map((one) => [one, one]);

/** @param {string} name @param {() => void} act */
export const removal = (name, act) =>
  h(
    'button',
    {type: 'button', class: 'quiet remove', 'aria-label': t('page.editor.remove', {name}), onclick: act},
    '×',
  );

/** @param {string} shown @param {() => void} act */
export const adding = (shown, act) => h('button', {type: 'button', class: 'editor-add', onclick: act}, `+ ${shown}`);
