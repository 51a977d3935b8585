// The header: name, connection, interface, theme.

import {fill, h} from './dom.js';
import {language, speak} from '../i18n/language.js';
import {retell, text} from '../i18n/pages.js';

const ICON = 'M8 2.500a5.500 5.500 0 0 1 0 11z';

const PAGES = [
  ['live', '/'],
  ['runs', '/runs/'],
  ['plants', '/plants/'],
  ['records', '/records/'],
];

/**
 * The header of a page; `here` is its name among the pages. `again` builds the rest of the page in another language; without it the page is loaded
 * anew, where nothing is lost by that.
 */
export function mountTop(root, connection, here = 'runs', again = null) {
  const state = h('span', {class: 'connection', role: 'status'});
  const theme = h('button', {class: 'quiet', type: 'button', onclick: () => window.theme.toggle()});
  const showConnection = () => {
    state.classList.toggle('lost', connection.lost);
    fill(state, h('span', {class: 'dot'}), connection.lost ? text.lost : text.connected);
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
    theme.title = text.themeHint;
    fill(theme, icon, h('span', {}, window.theme.now === 'dark' ? text.toLight : text.toDark));
  };
  const turn = (other) => {
    speak(other);
    if (!again) return location.reload();
    retell();
    build();
    root.querySelector('[lang]').focus();
    return again();
  };
  const build = () => {
    const [now, other] = language() === 'zh' ? ['zh-CN', 'en'] : ['en', 'zh'];
    document.documentElement.lang = now;
    showConnection();
    showTheme();
    fill(
      root,
      h('a', {class: 'logo', href: '/'}, h('i', {class: 'hat'}, 'θ'), h('span', {}, text.title)),
      h(
        'nav',
        {class: 'pages', 'aria-label': text.pages},
        PAGES.map(([name, href]) => h('a', {href, 'aria-current': name === here ? 'page' : null}, text.page[name])),
      ),
      h('span', {class: 'grow'}),
      state,
      h('button', {class: 'quiet', type: 'button', lang: other, onclick: () => turn(other)}, text.languageHint),
      h('a', {class: 'quiet', href: '/docs', title: text.interfaceHint}, text.interface),
      theme,
    );
  };
  connection.addEventListener('change', showConnection);
  addEventListener('theme', showTheme);
  build();
}
