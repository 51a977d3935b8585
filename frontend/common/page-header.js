// The header of the pages, and what it shares with that of the live page: names of pages, of languages, keys.

import {fill, h} from './dom.js';
import {rememberLanguage} from '../i18n/language.js';
import {language, speak, t} from '../i18n/words.js';

const ICON = 'M8 2.500a5.500 5.500 0 0 1 0 11z';

const PAGES = [
  ['learn', '/learn/'],
  ['live', '/'],
  ['workshop', '/workshop/'],
  ['records', '/records/'],
  ['runs', '/runs/'],
];

/**
 * Links to the pages; `here` is the name of the one that is shown.
 * @param {string} here
 */
export const pageLinks = (here) =>
  PAGES.map(([name, href]) => h('a', {href, 'aria-current': name === here ? 'page' : null}, t(`page.nav.${name}`)));

/** The languages by their own names, the present one in ink. */
export const languageNames = () => {
  /** @param {string} one @param {string} name */
  const name = (one, name) => h('span', {class: language() === one ? 'now' : null, lang: one}, name);
  return [name('en', 'EN'), ' · ', name('zh', '中文')];
};

/**
 * The header of a page; `here` is its name among the pages. `again` rebuilds the rest of the page in another language;
 * without it the page is reloaded, where nothing is lost by that.
 * @param {HTMLElement} root
 * @param {typeof import('./api.js').connection} connection
 * @param {string} [here]
 * @param {(() => void) | null} [again]
 */
export function mountTop(root, connection, here = 'runs', again = null) {
  const state = h('span', {class: 'connection', role: 'status'});
  const languages = h('button', {class: 'quiet languages', type: 'button', onclick: () => turn()});
  const theme = h('button', {class: 'quiet', type: 'button', onclick: () => window.theme.toggle()});
  const showConnection = () => {
    state.classList.toggle('lost', connection.lost);
    fill(
      state,
      h('span', {class: 'dot'}),
      connection.lost ? t('page.header.connection-lost') : t('page.header.connected'),
    );
  };
  /** @param {HTMLElement} button @param {string} words */
  const hint = (button, words) => {
    button.title = words;
    button.setAttribute('aria-label', words);
  };
  const label = () => {
    hint(languages, t('page.header.language.hint'));
    hint(theme, t('page.header.look.hint'));
    fill(languages, languageNames());
  };
  const turn = async () => {
    const other = language() === 'zh' ? 'en' : 'zh';
    rememberLanguage(other);
    if (!again) return location.reload();
    await speak(other);
    build();
    languages.focus();
    return again();
  };
  const build = () => {
    showConnection();
    label();
    fill(
      root,
      h('a', {class: 'logo', href: '/'}, h('i', {class: 'hat'}, 'θ'), h('span', {}, 'Thetascope')),
      h('nav', {class: 'pages', 'aria-label': t('page.nav.label')}, pageLinks(here)),
      h('span', {class: 'grow'}),
      state,
      h('a', {class: 'quiet', href: '/docs', title: t('page.header.interface.hint')}, t('page.header.interface')),
      languages,
      theme,
    );
  };
  fill(
    theme,
    h(
      'svg',
      {
        viewBox: '0 0 16 16',
        width: 15,
        height: 15,
        fill: 'none',
        stroke: 'currentColor',
        'stroke-width': 1.6,
        'aria-hidden': 'true',
      },
      h('circle', {cx: 8, cy: 8, r: 5.5}),
      h('path', {d: ICON, fill: 'currentColor'}),
    ),
  );
  connection.addEventListener('change', showConnection);
  addEventListener('keydown', (event) => {
    const typing =
      event.target instanceof Element && event.target.closest('input, select, textarea, [contenteditable]');
    if (typing || event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    if (event.key === 'l') turn();
    if (event.key === 't') window.theme.toggle();
  });
  build();
}
