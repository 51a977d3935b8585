// The page for a projector: the curves, and beside them the diagnosis, the plant and one card whose tabs hold the
// other panels. Panels are moved there and back: their order in the document is that on the screen, they keep typed
// text, and exist once. Styles: presentation.css.

import {fill, h, query} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import {App} from '../types.js' */

/** @typedef {Map<string, HTMLButtonElement>} Tabs   panel name → its tab */

/** The tabs with their keys; behind each is the panel of that name. */
export const TABS = /** @type {{[name: string]: string}} */ ({
  inject: 'I',
  inputs: 'U',
  truth: 'R',
  observers: 'O',
  comparison: 'M',
  log: 'G',
  try: 'Y',
});
const ABOVE = ['diagnosis', 'plant'];
const WIDE = '(min-width: 960px)'; // as in presentation.css: where the screen is narrower, panels stay in their places

const names = Object.keys(TABS);
/** @param {string} name */
const panel = (name) => query(`#panel-${name}`);

/** @param {HTMLElement} main @param {App} app */
export function mountDesk(main, app) {
  const wide = matchMedia(WIDE);
  const homes = ['.left', '.right']
    .map((name) => query(name, main))
    .map((column) => ({column, panels: [...column.children]}));
  const tabs = new Map(
    names.map((name) => [
      name,
      h('button', {
        type: 'button',
        role: 'tab',
        id: `desk-${name}`,
        'aria-controls': `panel-${name}`,
        onclick: () => app.act.desk(name),
      }),
    ]),
  );
  const list = h(
    'div',
    {role: 'tablist', class: 'desk-tabs', onkeydown: (event) => walk(event, tabs, app)},
    ...tabs.values(),
  );
  const desk = h('div', {class: 'card desk'}, list);
  const beside = h('div', {class: 'col beside'}, desk);

  const arrange = () => {
    const on = app.state.presentation && wide.matches;
    if (on === beside.isConnected) return;
    keeping(main, () => {
      for (const name of names) become(panel(name), on ? `desk-${name}` : null);
      if (on) {
        beside.prepend(...ABOVE.map(panel));
        desk.append(...names.map(panel));
        main.append(beside);
      } else {
        for (const {column, panels} of homes) column.append(...panels);
        beside.remove();
      }
    });
    choose(app.state.desk);
  };
  /** @param {string} chosen */
  const choose = (chosen) => {
    for (const [name, tab] of tabs) {
      tab.setAttribute('aria-selected', String(name === chosen));
      tab.tabIndex = name === chosen ? 0 : -1;
      panel(name).toggleAttribute('data-off', beside.isConnected && name !== chosen);
    }
  };
  wide.addEventListener('change', arrange);
  watchEmpty(tabs, app);
  app.subscribe((state) => state.presentation, arrange);
  app.subscribe((state) => state.desk, choose);
  app.subscribe(
    (state) => state.site,
    (site) => {
      if (site) app.act.desk('inject');
    },
  ); // before the panel opens the row: it is mounted later
  app.subscribe(
    (state) => state.language,
    () => label(list, tabs),
  );
}

/** @param {HTMLElement} list @param {Tabs} tabs */
function label(list, tabs) {
  list.setAttribute('aria-label', t('page.desk.label'));
  for (const [name, tab] of tabs) {
    const words = t(`page.desk.${name}`);
    fill(tab, words);
    tab.title = t('page.desk.tab', {name: words, key: TABS[name]});
  }
}

/**
 * Make a place the panel of a tab, or (null) an ordinary place again.
 * @param {HTMLElement} element
 * @param {string | null} tab
 */
function become(element, tab) {
  if (tab) {
    element.setAttribute('role', 'tabpanel');
    element.setAttribute('aria-labelledby', tab);
  } else for (const name of ['role', 'aria-labelledby']) element.removeAttribute(name);
}

/**
 * Move elements without losing the focus, nor where lists are scrolled to.
 * @param {HTMLElement} main
 * @param {() => void} move
 */
function keeping(main, move) {
  const focused = document.activeElement;
  const scrolled = [...main.querySelectorAll('.scroll')].map((one) => ({one, top: one.scrollTop}));
  move();
  for (const {one, top} of scrolled) one.scrollTop = top;
  if (focused instanceof HTMLElement && main.contains(focused) && document.activeElement !== focused)
    focused.focus({preventScroll: true});
}

/**
 * A panel that has nothing to show hides itself; its tab keeps its place and cannot be chosen.
 * @param {Tabs} tabs
 * @param {App} app
 */
function watchEmpty(tabs, app) {
  const look = () => {
    for (const [name, tab] of tabs) tab.disabled = panel(name).matches('[hidden]');
    // while a session is opened, all of them are empty
    if (app.state.plant && tabs.get(app.state.desk)?.disabled) app.act.desk(names[0]);
  };
  const watcher = new MutationObserver(look);
  for (const name of names) watcher.observe(panel(name), {attributeFilter: ['hidden']});
  app.subscribe(
    (state) => state.plant,
    () => queueMicrotask(look),
  );
}

/**
 * Arrows, Home and End go from tab to tab.
 * @param {KeyboardEvent} event
 * @param {Tabs} tabs
 * @param {App} app
 */
function walk(event, tabs, app) {
  const open = names.filter((name) => !tabs.get(name)?.disabled);
  const at = open.indexOf(app.state.desk);
  const next = {
    ArrowRight: (at + 1) % open.length,
    ArrowLeft: (at + open.length - 1) % open.length,
    Home: 0,
    End: open.length - 1,
  }[event.key];
  if (next === undefined) return;
  event.preventDefault();
  app.act.desk(open[next]);
  tabs.get(open[next])?.focus();
}
