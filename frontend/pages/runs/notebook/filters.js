// The second bar with search, time, groups and the new run; and the list of kinds and tags beside the table.

import {fill, h} from '../../../common/dom.js';
import {SPANS} from './filter.js';
import {t} from '../../../i18n/words.js';

/** @import {NotebookActions, NotebookState} from './notebook.js' */

/**
 * @param {HTMLElement} root
 * @param {NotebookActions} act
 */
export function createBar(root, act) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const columns = h('span', {class: 'columns-place'});
  const sum = h('small', {class: 'soft'});
  /** @type {HTMLInputElement} */
  const search = h('input', {
    type: 'search',
    class: 'find',
    placeholder: t('page.notebook.find.example'),
    'aria-label': t('page.notebook.find'),
    oninput: () => {
      clearTimeout(timer);
      timer = setTimeout(() => act.filter({q: search.value.trim()}), 250);
    },
  });
  const since = choice(
    t('page.notebook.since'),
    ['any', ...SPANS].map((value) => [value, t(`page.notebook.since.${value}`)]),
    (value) => act.filter({since: value}),
  );
  const group = choice(
    t('page.notebook.group'),
    ['experiment', 'tags', 'none'].map((value) => [value, t(`page.notebook.group.${value}`)]),
    (value) => act.filter({group: value}),
  );
  fill(
    root,
    h('div', {class: 'bar-name'}, h('h1', {}, t('page.nav.runs')), sum),
    h('div', {class: 'bar-find'}, search, since.element),
    h(
      'div',
      {class: 'bar-actions'},
      h('label', {class: 'group-by'}, h('span', {class: 'soft'}, t('page.notebook.group')), group.element),
      columns,
      h('a', {class: 'run', href: '/runs/?new'}, t('page.notebook.new-run')),
    ),
  );

  /** @param {NotebookState} state */
  function show({filter, counts}) {
    const {run = 0, session = 0, record = 0} = counts.kinds;
    const parts = [
      t('page.notebook.runs', {n: run}),
      session > 0 && t('page.notebook.sessions', {n: session}),
      record > 0 && t('page.notebook.records', {n: record}),
    ];
    fill(sum, parts.filter(Boolean).join(t('page.text.comma')));
    if (document.activeElement !== search) search.value = filter.q;
    since.element.value = filter.since;
    group.element.value = filter.group;
  }
  return {show, search, columns};
}

/**
 * A list to choose from.
 * @param {string} label
 * @param {string[][]} options   values and words
 * @param {(value: string) => void} choose
 */
function choice(label, options, choose) {
  /** @type {HTMLSelectElement} */
  const element = h(
    'select',
    {'aria-label': label, onchange: () => choose(element.value)},
    options.map(([value, words]) => h('option', {value}, words)),
  );
  return {element};
}

/**
 * @param {HTMLElement} root
 * @param {NotebookActions} act
 */
export function createShelf(root, act) {
  root.setAttribute('aria-label', t('page.notebook.shelf'));

  /** @param {NotebookState} state */
  function show({filter, counts, tags}) {
    const focused = root.contains(document.activeElement) ? document.activeElement?.getAttribute('data-key') : null;
    const free = !filter.kind && !filter.tag && !filter.pinned;
    const {session = 0, record = 0} = counts.kinds;
    fill(
      root,
      h(
        'ul',
        {},
        entry('all', t('page.notebook.all'), counts.all, free, {}),
        entry('pinned', t('page.notebook.pinned'), counts.pinned, filter.pinned, {pinned: true}),
        entry('session', t('page.notebook.from-live'), session, filter.kind === 'session', {kind: 'session'}),
        entry('record', t('page.nav.records'), record, filter.kind === 'record', {kind: 'record'}),
        h('li', {}, h('a', {href: '/studies/'}, t('page.studies.title'))),
      ),
      tags.length > 0 && [
        h('h2', {}, t('page.notebook.tags')),
        h(
          'ul',
          {},
          tags.map(({tag, n}) => entry(`tag-${tag}`, tag, n, filter.tag === tag, {tag})),
        ),
      ],
    );
    const again = focused ? root.querySelector(`[data-key="${CSS.escape(focused)}"]`) : null;
    if (again instanceof HTMLElement) again.focus();
  }

  /** @param {string} key @param {string} words @param {number} n @param {boolean} current @param {object} only */
  const entry = (key, words, n, current, only) =>
    h(
      'li',
      {},
      h(
        'button',
        {
          type: 'button',
          'data-key': key,
          'aria-current': current ? 'true' : null,
          onclick: () => act.filter({kind: '', tag: '', pinned: false, ...only}),
        },
        h('span', {}, words),
        h('span', {class: 'n'}, n),
      ),
    );
  return {show};
}
