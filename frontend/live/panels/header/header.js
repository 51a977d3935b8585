// The header: name, pages, connection, share, export, language, projector, theme.

import {fill, h} from '../../../common/dom.js';
import {times} from '../../../widgets/number-format.js';
import {open} from '../dialogs/open-dialog.js';
import {icon} from '../../../widgets/svg.js';
import {mountTabs} from './tabs.js';

export function mount(element, app) {
  const state = h('span', {class: 'connection', role: 'status'});
  const words = h('span', {});
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
    if (event.target.closest('button')) fold(false);
  });
  document.addEventListener('pointerdown', (event) => {
    if (!element.contains(event.target)) fold(false);
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

  const named = (one, name, hint) => {
    one.title = hint;
    one.setAttribute('aria-label', hint);
    one.lastChild.textContent = name;
  };
  /** The button that begins the presentation is the way out of it. */
  const showPresent = () => {
    const {
      text,
      state: {presentation: on},
    } = app;
    present.firstChild.replaceWith(icon(on ? 'close' : 'screen'));
    named(present, on ? text.leave : text.present, on ? text.leaveHint : text.presentHint);
  };
  const label = () => {
    const {text} = app;
    fill(nav, pages(text, 'live'));
    fill(document.querySelector('.skip'), text.skip);
    fill(document.querySelector('#scope > h2'), text.tabs.curves);
    nav.setAttribute('aria-label', text.pages);
    more.setAttribute('aria-label', text.moreActions);
    named(share, text.share, text.shareHint);
    named(take, text.export, text.exportHint);
    showPresent();
    named(theme, text.look, text.themeHint);
    named(help, text.help, text.helpHint);
    const chinese = app.state.language === 'zh';
    fill(
      language,
      h('span', {class: chinese ? null : 'now', lang: 'en'}, 'EN'),
      ' · ',
      h('span', {class: chinese ? 'now' : null, lang: 'zh'}, '中文'),
    );
    language.setAttribute('aria-label', text.languageHint);
    language.title = text.languageHint;
    connect();
  };
  const connect = () => {
    const {connection, role, viewers, playing, rate, speed} = app.state;
    const {text} = app;
    state.className = `connection ${connection}`;
    const slow = playing && speed !== null && rate !== null && rate < 0.8 * speed ? text.slow(times(rate)) : null;
    const said = [
      role === 'view' ? text.viewing : null,
      text.connections[connection] ?? connection,
      viewers > 1 ? text.viewers(viewers) : null,
      slow,
    ]
      .filter(Boolean)
      .join(' · ');
    if (words.textContent !== said) words.textContent = said;
    if (!words.isConnected) fill(state, h('span', {class: 'dot'}), words);
  };
  app.subscribe((s) => s.language, label);
  app.subscribe((s) => [s.connection, s.role, s.viewers], connect);
  app.subscribe(
    (s) => s.role,
    (role) => document.documentElement.classList.toggle('view-only', role === 'view'),
  );
  app.subscribe((s) => s.presentation, showPresent);
  mountTabs(app);
}

/** Links to the pages; `here` is the one that is shown. */
export function pages(text, here) {
  return [
    ['live', '/'],
    ['runs', '/runs/'],
    ['plants', '/plants/'],
    ['records', '/records/'],
  ].map(([name, href]) => h('a', {href, 'aria-current': name === here ? 'page' : null}, text.page[name]));
}
