// The editor where CodeMirror is not installed: a plain field, with the errors listed below it.

import {fill, h} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {errorLine} from './error-line.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Editor, EditorEvents} from '../types.js' */

/**
 * The offset of a place in a text.
 * @param {string} text
 * @param {{line: number, column: number}} place
 */
export function offset(text, {line, column}) {
  let start = 0;
  for (let number = 1; number < line; number += 1) {
    const end = text.indexOf('\n', start);
    if (end < 0) return text.length;
    start = end + 1;
  }
  return Math.min(text.length, start + column - 1);
}

/**
 * @param {string} text
 * @param {EditorEvents} events
 * @returns {Editor}
 */
export function plainEditor(text, events) {
  const field = h('textarea', {
    class: 'plain-text',
    spellcheck: 'false',
    autocapitalize: 'off',
    'aria-label': t('page.workshop.editor'),
    oninput: ({currentTarget}) => events.change(currentTarget.value),
    onkeyup: place,
    onclick: place,
  });
  field.value = text;
  const list = h('ol', {class: 'plain-errors'});
  const element = h('div', {class: 'editor plain'}, field, list);

  function place() {
    const before = field.value.slice(0, field.selectionStart).split('\n');
    events.cursor(before.length, (before.at(-1) ?? '').length + 1);
  }

  /** @param {service.TextPlace} at @param {string} by */
  function replace(at, by) {
    const start = offset(field.value, at);
    field.focus();
    field.setSelectionRange(start, start + at.length);
    // the only command that keeps the field's own undo
    if (!document.execCommand('insertText', false, by)) field.setRangeText(by);
    events.change(field.value);
  }

  field.addEventListener('keydown', (event) => {
    const command = event.metaKey || event.ctrlKey;
    const act = event.key === 's' ? events.save : event.key === 'Enter' ? events.live : null;
    if (command && act) {
      event.preventDefault();
      act();
    } else if (event.altKey && event.key === 'Enter') {
      event.preventDefault();
      events.fix();
    } else if (event.key === 'F8') events.next();
  });
  return {
    element,
    text: () => field.value,
    setText(next, asEdit = false) {
      if (asEdit) replace({line: 1, column: 1, length: field.value.length}, next);
      else field.value = next;
    },
    showErrors(errors, apply) {
      field.setAttribute('aria-invalid', String(errors.some((one) => one.severity === 'error')));
      fill(
        list,
        errors.map((error) =>
          h(
            'li',
            {},
            errorLine(error, () => apply(error)),
          ),
        ),
      );
    },
    replace,
    select(at) {
      const start = offset(field.value, at);
      field.focus();
      field.setSelectionRange(start, start + at.length);
    },
    names() {},
    mark() {},
    undo: () => document.execCommand('undo'),
  };
}
