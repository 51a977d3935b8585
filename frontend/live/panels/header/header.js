// The header: name, pages, connection, share, export, language, projector, theme.

import {fill, h, query} from '../../../common/dom.js';
import {languageNames, pageLinks} from '../../../common/page-header.js';
import {times} from '../../../widgets/number-format.js';
import {open} from '../dialogs/open-dialog.js';
import {icon} from '../../../widgets/svg.js';
import {mountTabs} from './tabs.js';
import {t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const state = h('span', {class: 'connection', role: 'status'});
  const words = h('span', {});
  /** @param {'share' | 'export' | 'screen' | 'theme' | 'help'} name @param {() => void} act */
  const button = (name, act) => h('button', {type: 'button', class: 'quiet', onclick: act}, icon(name), h('span', {}));
  const share = button('share', () => open('share'));
  const take = button('export', () => open('export'));
  const language = h('button', {
    type: 'button',
    class: 'quiet languages',
    onclick: () => app.act.language(app.state.language === 'en' ? 'zh' : 'en'),
  });
  const present = button('screen', () => app.act.present(!app.state.presentation));
  const theme = button('theme', () => app.act.theme(app.state.theme === 'dark' ? 'light' : 'dark'));
  const help = button('help', () => open('help'));
  const nav = h('nav', {class: 'pages'});
  const actions = h(
    'div',
    {class: 'actions', id: 'actions'},
    share,
    take,
    language,
    h('span', {class: 'marks'}, present, theme, help),
  );
  /** @param {boolean} open */
  const fold = (open) => {
    actions.classList.toggle('open', open);
    more.setAttribute('aria-expanded', String(open));
  };
  const more = h(
    'button',
    {
      type: 'button',
      class: 'quiet more-actions',
      'aria-expanded': 'false',
      'aria-controls': 'actions',
      onclick: () => fold(!actions.classList.contains('open')),
    },
    '⋯',
  );
  actions.addEventListener('click', (event) => {
    if (event.target instanceof Element && event.target.closest('button')) fold(false);
  });
  document.addEventListener('pointerdown', (event) => {
    if (event.target instanceof Node && !element.contains(event.target)) fold(false);
  });
  fill(
    element,
    h(
      'a',
      {class: 'logo', href: '/', 'aria-label': 'Thetascope'},
      h('i', {class: 'hat'}, 'θ'),
      h('span', {}, 'Thetascope'),
    ),
    nav,
    h('span', {class: 'grow'}),
    state,
    actions,
    more,
  );

  /**
   * @param {HTMLElement} one
   * @param {string} name
   * @param {string} hint
   */
  const named = (one, name, hint) => {
    one.title = hint;
    one.setAttribute('aria-label', hint);
    if (one.lastChild) one.lastChild.textContent = name;
  };
  /** The button that begins the presentation is the way out of it. */
  const showPresent = () => {
    const on = app.state.presentation;
    present.firstElementChild?.replaceWith(icon(on ? 'close' : 'screen'));
    named(
      present,
      on ? t('page.header.leave') : t('page.header.present'),
      on ? t('page.header.leave.hint') : t('page.header.present.hint'),
    );
  };
  const label = () => {
    fill(nav, pageLinks(app.state.lesson ? 'learn' : 'live'));
    fill(query('.skip'), t('page.nav.skip-to-curves'));
    fill(query('#scope > h2'), t('page.tabs.curves'));
    nav.setAttribute('aria-label', t('page.nav.label'));
    more.setAttribute('aria-label', t('page.header.more'));
    named(share, t('page.header.share'), t('page.header.share.hint'));
    named(take, t('page.header.export'), t('page.header.export.hint'));
    showPresent();
    named(theme, t('page.header.look'), t('page.header.look.hint'));
    named(help, t('page.header.help'), t('page.header.help.hint'));
    fill(language, languageNames());
    language.setAttribute('aria-label', t('page.header.language.hint'));
    language.title = t('page.header.language.hint');
    connect();
  };
  const connect = () => {
    const {connection, role, viewers, playing, rate, speed} = app.state;
    state.className = `connection ${connection}`;
    const slow =
      playing && speed !== null && rate !== null && rate < 0.8 * speed
        ? t('page.header.slow', {rate: times(rate)})
        : null;
    const said = [
      role === 'view' ? t('page.header.view-only') : null,
      t(`page.header.connection.${connection}`),
      viewers > 1 ? t('page.header.viewers', {n: viewers}) : null,
      slow,
    ]
      .filter(Boolean)
      .join(' · ');
    if (words.textContent !== said) words.textContent = said;
    if (!words.isConnected) fill(state, h('span', {class: 'dot'}), words);
  };
  app.subscribe((s) => [s.language, s.lesson === null], label);
  app.subscribe((s) => [s.connection, s.role, s.viewers], connect);
  app.subscribe(
    (s) => s.role,
    (role) => document.documentElement.classList.toggle('view-only', role === 'view'),
  );
  app.subscribe((s) => s.presentation, showPresent);
  mountTabs(app);
}
