// One error under its line: the problem, the remedy, and a button that applies it.

import {h} from '../../../common/dom.js';
import {asSentence, t} from '../../../i18n/words.js';

/** @import {TextError} from '../types.js' */

/**
 * @param {TextError} error
 * @param {() => void} apply
 */
export function errorLine(error, apply) {
  return h(
    'div',
    {class: `lint ${error.severity}`, role: 'note'},
    h(
      'span',
      {},
      h('b', {}, asSentence(error.problem)),
      ' ',
      error.fix ? '' : h('span', {class: 'visually-hidden'}, t('page.workshop.line', {n: error.place.line})),
      asSentence(error.remedy),
    ),
    error.fix && h('button', {type: 'button', class: 'press', onclick: apply}, verb(error), h('kbd', {}, 'Alt ↵')),
  );
}

/** What the button does. @param {TextError} error */
function verb({fix, place}) {
  if (!fix) return '';
  if (fix.length === 0) return t('page.workshop.fix.insert');
  if (fix.text === '') return t('page.workshop.fix.delete');
  return fix.line === place.line ? t('page.workshop.fix.replace') : t('page.workshop.fix.change');
}
