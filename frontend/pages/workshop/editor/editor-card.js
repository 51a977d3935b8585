// The card of the editor: its head with the file's name and format, the editor, and its foot with the state.

import {fill, h} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {errorsOf, idIn} from '../store.js';

/** @import {Editor, ShopActions, ShopStore} from '../types.js' */

/**
 * @param {HTMLElement} root
 * @param {Editor} editor
 * @param {ShopStore} store
 * @param {ShopActions} act
 */
export function mountEditorCard(root, editor, store, act) {
  root.setAttribute('aria-label', t('page.workshop.editor'));
  const file = h('b');
  const place = h('span', {class: 'place'});
  const formats = h('div', {class: 'segments', role: 'group', 'aria-label': t('page.workshop.format')});
  const left = h('span', {class: 'verdict', role: 'status'});
  const kept = h('span');
  const apple = /mac|iphone|ipad/i.test(navigator.userAgent);
  const key = (/** @type {string} */ letter) => h('kbd', {}, apple ? `⌘${letter}` : `Ctrl ${letter}`);
  fill(
    root,
    h('div', {class: 'editor-head'}, file, place, formats),
    editor.element,
    h(
      'div',
      {class: 'editor-foot'},
      left,
      kept,
      h('span', {class: 'grow'}),
      h(
        'button',
        {type: 'button', class: 'plain-button', onclick: () => editor.undo()},
        t('page.workshop.undo'),
        ' ',
        key('Z'),
      ),
      h('span', {class: 'hint'}, t('page.workshop.find'), ' ', key('F')),
      h('span', {class: 'hint'}, t('page.workshop.names'), ' ', h('kbd', {}, apple ? '⌃Space' : 'Ctrl Space')),
    ),
  );

  store.subscribe(
    (state) => [idIn(state.text), state.text.trimStart().startsWith('{')],
    (state) => {
      const format = state.text.trimStart().startsWith('{') ? 'json' : 'yaml';
      file.textContent = `${idIn(state.text) || 'plant'}.${format}`;
      fill(
        formats,
        /** @type {const} */ (['yaml', 'json']).map((one) =>
          h(
            'button',
            {type: 'button', 'aria-pressed': String(one === format), onclick: () => one !== format && act.convert(one)},
            one.toUpperCase(),
          ),
        ),
      );
    },
  );
  store.subscribe(
    (state) => state.cursor,
    ({cursor}) => {
      place.textContent = t('page.workshop.cursor', {line: cursor.line, column: cursor.column});
    },
  );
  store.subscribe(
    (state) => [state.check, state.checking],
    (state) => {
      const errors = errorsOf(state);
      const warnings = (state.check?.errors.length ?? 0) - errors.length;
      const words = errors.length
        ? t('page.workshop.errors.count', {n: errors.length})
        : warnings
          ? t('page.workshop.warnings.count', {n: warnings})
          : t('page.workshop.no-errors');
      left.classList.toggle('busy', state.checking);
      fill(
        left,
        h('span', {class: `light ${errors.length ? 'bad' : warnings ? 'warn' : 'ok'}`}),
        state.check ? words : t('page.text.loading'),
      );
    },
  );
  store.subscribe(
    (state) => state.kept,
    (state) => {
      kept.textContent = state.kept === null ? '' : t('page.workshop.kept');
    },
  );
}
