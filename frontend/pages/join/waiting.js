// Joining with a code, and waiting for the teacher: who one is, and how to be called otherwise.

import {fill, h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import {Phone} from './join.js' */
/** @import * as service from '../../types/service.js' */

/** The form for the code. @param {Phone} phone */
export function drawJoin(phone) {
  const typed = /** @type {HTMLInputElement | null} */ (document.querySelector('#code'))?.value ?? '';
  const code = h('input', {
    id: 'code',
    class: 'seat-code',
    'data-keep': 'code',
    autocomplete: 'off',
    autocapitalize: 'characters',
    spellcheck: 'false',
    maxlength: 12,
    required: true,
    'aria-describedby': 'join-hint',
  });
  code.value = typed;
  fill(
    phone.main,
    h('h1', {}, t('page.join.title')),
    h(
      'form',
      {
        id: 'join-form',
        class: 'seat-form',
        onsubmit: (event) => {
          event.preventDefault();
          phone.join('/api/classroom/join', {code: code.value});
        },
      },
      h('label', {for: 'code', id: 'join-hint'}, t('page.join.hint')),
      code,
    ),
    phone.problem && h('p', {class: 'seat-problem', role: 'alert'}, phone.problem),
    h('p', {class: 'soft'}, t('page.join.private')),
  );
  fill(
    phone.foot,
    h('button', {class: 'run', type: 'submit', form: 'join-form', 'data-keep': 'act'}, t('page.join.join')),
  );
}

/** @param {Phone} phone @param {service.SeatView} state */
export function drawWaiting(phone, state) {
  const before = /** @type {HTMLInputElement | null} */ (document.querySelector('#name'))?.value;
  const name = h('input', {
    id: 'name',
    'data-keep': 'name',
    autocomplete: 'off',
    maxlength: 24,
    placeholder: phone.called,
  });
  name.value = before ?? state.name ?? '';
  fill(
    phone.main,
    h('p', {class: 'seat-eyebrow'}, t('page.join.you-are')),
    h('h1', {class: 'seat-big'}, phone.called),
    h('p', {class: 'soft'}, t('page.join.nickname')),
    h(
      'form',
      {
        class: 'seat-form',
        onsubmit: async (event) => {
          event.preventDefault();
          if (await phone.ask('PUT', '/name', {name: name.value.trim() || null})) phone.renaming = false;
          phone.draw();
        },
      },
      h('label', {for: 'name'}, t('page.join.name')),
      h('div', {class: 'seat-name'}, name, h('button', {class: 'quiet', type: 'submit'}, t('page.join.use-name'))),
    ),
    h(
      'button',
      {
        class: 'quiet second',
        type: 'button',
        'data-keep': 'animal',
        onclick: () => {
          name.value = '';
          phone.ask('PUT', '/name', {name: null});
        },
      },
      t('page.join.other-animal'),
    ),
    phone.problem && h('p', {class: 'seat-problem', role: 'alert'}, phone.problem),
  );
  fill(
    phone.foot,
    !phone.renaming && h('p', {class: 'soft', role: 'status'}, t('page.join.waiting')),
    phone.renaming
      ? h('button', {class: 'run', type: 'button', onclick: () => back(phone)}, t('page.join.back'))
      : h('button', {class: 'quiet second', type: 'button', onclick: () => phone.leave()}, t('page.join.leave')),
  );
}

/** @param {Phone} phone */
function back(phone) {
  phone.renaming = false;
  phone.draw();
}
