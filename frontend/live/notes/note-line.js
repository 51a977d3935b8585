// A note in the log: its moment and text, and for who controls the session the buttons that change and remove it.

import {h} from '../../common/dom.js';
import {icon} from '../../widgets/svg.js';
import {lineOf, momentOf} from './note-words.js';
import {t} from '../../i18n/words.js';

/** @import {App, Note} from '../types.js' */

/** @param {Note} note @param {App} app */
export function noteLine(note, app) {
  const at = momentOf(note, app.state);
  /** @param {'edit' | 'close'} name @param {string} words @param {() => unknown} act */
  const button = (name, words, act) =>
    h(
      'button',
      {
        type: 'button',
        class: 'plain control-only',
        title: words,
        'aria-label': t('page.notes.of', {action: words, note: lineOf(note, app.state)}),
        onclick: act,
      },
      icon(name, 13),
    );
  return h(
    'li',
    {class: 'note own', 'data-note': note.id},
    h(
      'button',
      {type: 'button', class: 'moment', title: t('page.log.show'), onclick: () => app.act.notes.visit(note)},
      h('span', {class: 'time'}, (app.state.spec?.horizon ?? 0) >= 1000 ? note.t.toFixed(0) : at),
      h('span', {}, note.text ? t('page.notes.in-log', {text: note.text}) : t('page.notes.in-log.bookmark')),
    ),
    button('edit', t('page.notes.edit'), () => app.act.notes.edit(note)),
    button('close', t('page.notes.remove'), () => app.act.notes.remove(note)),
  );
}
