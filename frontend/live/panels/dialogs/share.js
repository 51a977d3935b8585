// Links to this session: one that opens a copy of it, one that views this session itself.

import {reason} from '../../../common/api.js';
import {fill, h} from '../../../common/dom.js';
import {icon} from '../../../widgets/svg.js';
import {t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */

/** @param {HTMLElement} body @param {App} app */
export async function showShare(body, app) {
  fill(body, h('p', {class: 'soft'}, t('page.text.loading')));
  /** @type {[string, string, {view?: boolean}][]} */
  const kinds = [
    [t('page.share.copy'), t('page.share.copy.hint'), {}],
    [t('page.share.view'), t('page.share.view.hint'), {view: true}],
  ];
  try {
    const links = await Promise.all(kinds.map(([, , options]) => app.act.link(options)));
    fill(
      body,
      kinds.map(([title, hint], place) => row(title, hint, new URL(links[place], location.href).href)),
      app.state.session &&
        h(
          'section',
          {class: 'share'},
          h('h3', {}, t('page.share.lesson')),
          h('p', {class: 'soft'}, t('page.share.lesson.hint')),
          h(
            'a',
            {class: 'press', href: `/lesson-editor/?session=${encodeURIComponent(app.state.session)}`},
            t('page.share.lesson'),
          ),
        ),
    );
    body.querySelector('button')?.focus();
  } catch (error) {
    fill(body, h('p', {class: 'alarm'}, reason(error).message));
  }
}

/**
 * @param {string} title
 * @param {string} hint
 * @param {string} address
 */
function row(title, hint, address) {
  /** @type {HTMLInputElement} */
  const field = h('input', {
    type: 'text',
    readonly: true,
    value: address,
    'aria-label': title,
    onfocus: () => field.select(),
  });
  const copied = h('span', {class: 'soft', role: 'status'});
  const copy = h(
    'button',
    {
      type: 'button',
      class: 'press',
      onclick: async () => {
        try {
          await navigator.clipboard.writeText(address);
        } catch {
          // without permission, or without https
          field.select();
          document.execCommand('copy');
        }
        copied.textContent = t('page.action.copied');
        setTimeout(() => {
          copied.textContent = '';
        }, 2500);
      },
    },
    icon('link', 13),
    ' ',
    t('page.action.copy'),
  );
  return h(
    'section',
    {class: 'share'},
    h('h3', {}, title),
    h('p', {class: 'soft'}, hint),
    h('div', {class: 'copy-row'}, field, copy),
    copied,
  );
}
