// The header: name, connection, interface, theme.

import {fill, h, query} from './dom.js';
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
  const theme = h('button', {class: 'quiet', type: 'button', onclick: () => window.theme.toggle()});
  const showConnection = () => {
    state.classList.toggle('lost', connection.lost);
    fill(
      state,
      h('span', {class: 'dot'}),
      connection.lost ? t('page.header.connection-lost') : t('page.header.connected'),
    );
  };
  const showTheme = () => {
    const icon = h(
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
    );
    theme.title = t('page.header.theme.hint');
    fill(
      theme,
      icon,
      h('span', {}, window.theme.now === 'dark' ? t('page.header.to-light') : t('page.header.to-dark')),
    );
  };
  /** @param {'en' | 'zh'} other */
  const turn = async (other) => {
    rememberLanguage(other);
    if (!again) return location.reload();
    await speak(other);
    build();
    query('[lang]', root).focus();
    return again();
  };
  const build = () => {
    const other = language() === 'zh' ? 'en' : 'zh';
    showConnection();
    showTheme();
    fill(
      root,
      h('a', {class: 'logo', href: '/'}, h('i', {class: 'hat'}, 'θ'), h('span', {}, 'Thetascope')),
      h('nav', {class: 'pages', 'aria-label': t('page.nav.label')}, pageLinks(here)),
      h('span', {class: 'grow'}),
      state,
      h(
        'button',
        {class: 'quiet', type: 'button', lang: other, onclick: () => turn(other)},
        t('page.header.language.other'),
      ),
      h('a', {class: 'quiet', href: '/docs', title: t('page.header.interface.hint')}, t('page.header.interface')),
      theme,
    );
  };
  connection.addEventListener('change', showConnection);
  addEventListener('theme', showTheme);
  build();
}
