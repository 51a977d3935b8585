// Notes that are kept with a comparison, whichever the order of its runs: saved while they are typed.

import {fill, h} from '../../../common/dom.js';
import {reason, request} from '../../../common/api.js';
import {t} from '../../../i18n/words.js';

const PAUSE = 600; // ms after the last key

/**
 * @param {HTMLElement} root
 * @param {string[]} ids
 * @param {string} text
 * @param {string} warning why the text is not shown, empty: it is
 */
export function createNotes(root, ids, text, warning) {
  let kept = text;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const state = h('span', {class: 'soft small', role: 'status'}, t('page.compare.notes.kept'));
  const field = h('textarea', {
    rows: 4,
    maxlength: 4000,
    'aria-label': t('page.compare.notes'),
    placeholder: t('page.compare.notes.hint'),
    oninput: () => {
      state.textContent = '';
      clearTimeout(timer);
      timer = setTimeout(keep, PAUSE);
    },
    onblur: () => keep(),
  });
  field.value = text;
  const damage = h('p', {class: 'alarm small', role: 'note', hidden: !warning}, warning);

  async function keep() {
    clearTimeout(timer);
    const wanted = field.value;
    if (wanted === kept) return;
    try {
      await request('PUT', `/api/runs/compare/notes?${new URLSearchParams({ids: ids.join(',')})}`, {
        body: {text: wanted},
      });
      kept = wanted;
      damage.hidden = true;
      if (field.value === kept) state.textContent = t('page.compare.notes.kept');
    } catch (error) {
      state.textContent = reason(error).message;
    }
  }
  fill(root, h('div', {class: 'heading'}, h('h2', {}, t('page.compare.notes')), state), damage, field);
}
