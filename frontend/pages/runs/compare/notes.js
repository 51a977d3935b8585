// Notes that are kept with a comparison, whichever the order of its runs: saved while they are typed.

import {fill, h} from '../../../common/dom.js';
import {reason, request} from '../../../common/api.js';
import {t} from '../../../i18n/words.js';

const PAUSE = 600; // ms after the last key

/**
 * @param {HTMLElement} root
 * @param {string[]} ids
 * @param {string} text
 */
export function createNotes(root, ids, text) {
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

  async function keep() {
    clearTimeout(timer);
    const wanted = field.value;
    if (wanted === kept) return;
    try {
      await request('PUT', `/api/runs/compare/notes?${new URLSearchParams({ids: ids.join(',')})}`, {
        body: {text: wanted},
      });
      kept = wanted;
      if (field.value === kept) state.textContent = t('page.compare.notes.kept');
    } catch (error) {
      state.textContent = reason(error).message;
    }
  }
  fill(root, h('div', {class: 'heading'}, h('h2', {}, t('page.compare.notes')), state), field);
}
