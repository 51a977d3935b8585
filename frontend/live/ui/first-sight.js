// The first minute: one plain sentence below the title of every panel and a line above them all, until they are hidden.

import {fill, h, query} from '../../common/dom.js';
import {open} from '../panels/dialogs/open-dialog.js';
import {named, t} from '../../i18n/words.js';

/** @import {App} from '../types.js' */

const KEY = 'thetascope.hints';
const PANELS = ['plant', 'truth', 'inject', 'try', 'diagnosis', 'observers', 'comparison', 'log'];

/** Whether the sentences are shown: at the first visits, until they are hidden; not where nothing can be kept. */
const wanted = () => {
  try {
    return localStorage.getItem(KEY) !== 'off';
  } catch {
    return false;
  }
};

/** @param {App} app */
export function mountFirstSight(app) {
  const line = h('section', {class: 'first-line', hidden: true});
  query('#main').prepend(line);
  const sentences = new Map(
    [...PANELS, 'scope'].map((name) => [name, h('p', {class: 'first-words', 'data-first': name})]),
  );
  /** @param {boolean} on */
  const show = (on) => {
    document.documentElement.classList.toggle('first-sight', on);
    line.hidden = !on || app.state.plant === null;
  };
  const words = () => {
    for (const [name, sentence] of sentences) sentence.textContent = t(`page.first.${name}`);
    line.setAttribute('aria-label', t('page.first.label'));
    fill(
      line,
      h('p', {}, h('b', {}, t('page.first.new')), ' ', t('page.first.running', {plant: named(app.state.plant?.title)})),
      h('span', {class: 'grow'}),
      h('a', {class: 'press', href: '/learn/'}, t('page.first.learn')),
      h('button', {type: 'button', class: 'quiet', onclick: () => open('help')}, t('page.first.glossary')),
      h('button', {type: 'button', class: 'quiet', onclick: () => hintsShown(false)}, t('page.first.hide')),
    );
    show(wanted());
  };
  for (const name of PANELS) place(query(`#panel-${name}`), '.heading', sentences.get(name));
  place(query('#scope'), '.scope-head', sentences.get('scope'));
  app.subscribe((state) => [state.language, state.plant], words);
  addEventListener('storage', ({key}) => key === KEY && show(wanted()));
  addEventListener('hints', () => show(wanted()));
}

/**
 * Show the sentences, or hide them, here and in the other tabs.
 * @param {boolean} on
 */
export function hintsShown(on) {
  try {
    if (on) localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, 'off');
  } catch {
    /* private windows keep nothing */
  }
  dispatchEvent(new Event('hints'));
}

/**
 * Keep a sentence below a panel's title, also where the panel draws itself anew.
 * @param {HTMLElement} panel
 * @param {string} title
 * @param {HTMLElement | undefined} sentence
 */
function place(panel, title, sentence) {
  if (!sentence) return;
  const keep = () => {
    const head = panel.querySelector(`:scope > ${title}`);
    if (!head) return;
    head.querySelector('h2')?.setAttribute('title', sentence.textContent ?? ''); // where there is no room for it
    if (head.nextSibling !== sentence) head.after(sentence);
  };
  new MutationObserver(keep).observe(panel, {childList: true});
  keep();
}
