// The table of runs: headings that sort, groups, rows. On a phone a row is a card.

import {fill, h, number} from '../../../common/dom.js';
import {plain} from '../../../common/names.js';
import {createColumnsMenu} from '../../../widgets/columns-menu.js';
import {addressOfRun, changesOf, nameOf, whenOf} from './line-words.js';
import {sparkline} from './sparkline.js';
import {named, t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */
/** @import {NotebookActions, NotebookState} from './notebook.js' */

const ACTIVE = new Set(['queued', 'running']);

/** The columns: name, the field that it is sorted by, class. @type {[string, string | null, string][]} */
const COLUMNS = [
  ['name', 'name', ''],
  ['changes', null, ''],
  ['curve', null, ''],
  ['rmse', 'rmse', 'r'],
  ['delay', 'delay', 'r'],
  ['false-alarms', 'false_alarms', 'r'],
  ['when', 'created', 'r'],
];

/**
 * @param {HTMLElement} root
 * @param {NotebookActions} act
 * @param {HTMLElement} columns   where the menu of columns is put
 */
export function createTable(root, act, columns) {
  /** @type {NotebookState | null} */
  let latest = null;
  const menu = createColumnsMenu('runs', () => latest && show(latest));
  menu.show(COLUMNS.slice(1).map(([name]) => [name, t(`page.notebook.column.${name}`)]));
  const head = h('tr');
  const table = h(
    'table',
    {class: 'runs-table'},
    h('caption', {class: 'unseen'}, t('page.nav.runs')),
    h('thead', {}, head),
  );
  const more = h('button', {type: 'button', class: 'quiet more-runs', onclick: act.more}, t('page.notebook.more'));
  const empty = h('div', {class: 'no-runs'});
  fill(root, table, empty, more);
  columns.append(menu.root);

  /** @param {NotebookState} state */
  function show(state) {
    latest = state;
    const {lines, groups, filter} = state;
    for (const [name] of COLUMNS) table.classList.toggle(`no-${name}`, name !== 'name' && !menu.shows(name));
    const focused = focusOf(table);
    fill(
      head,
      h('th', {class: 'tick'}, h('span', {class: 'unseen'}, t('page.notebook.column.chosen'))),
      h('th', {class: 'pin'}, h('span', {class: 'unseen'}, t('page.notebook.column.pinned'))),
      COLUMNS.map(([name, field, kind]) => heading(name, field, kind, state, act)),
      h('th', {class: 'more'}, h('span', {class: 'unseen'}, t('page.notebook.column.more'))),
    );
    for (const body of [...table.tBodies]) body.remove();
    const grouped = filter.group === 'none' ? [{key: '', runs: lines}] : byGroup(lines, filter.group);
    for (const {key, runs} of grouped) {
      const found = groups.find((one) => one.key === key);
      const body = h('tbody', {});
      if (filter.group !== 'none') body.append(groupRow(key, found, runs, filter.group));
      body.append(...runs.map((line) => row(line, state, act)));
      table.append(body);
    }
    table.hidden = !lines.length;
    more.hidden = !state.more;
    fill(empty, lines.length ? null : emptyWords(state));
    empty.hidden = lines.length > 0;
    restoreFocus(table, focused);
  }
  return {show};
}

/**
 * @param {string} name
 * @param {string | null} field
 * @param {string} kind
 * @param {NotebookState} state
 * @param {NotebookActions} act
 */
function heading(name, field, kind, {filter}, act) {
  const words = t(`page.notebook.column.${name}`);
  if (field === null) return h('th', {class: `${kind} c-${name}`}, words);
  const current = filter.sort === field;
  const order = current ? (filter.descending ? 'descending' : 'ascending') : null;
  const arrow = current && h('span', {'aria-hidden': 'true'}, filter.descending ? ' ↓' : ' ↑');
  const sort = () => act.sort(field);
  return h(
    'th',
    {class: `${kind} c-${name}`, 'aria-sort': order},
    h('button', {type: 'button', 'data-key': `sort-${field}`, onclick: sort}, words, arrow),
  );
}

/** @param {service.RunLine[]} lines @param {string} group */
function byGroup(lines, group) {
  /** @type {Map<string, service.RunLine[]>} */
  const groups = new Map();
  for (const line of lines) {
    const key = group === 'tags' ? keyOfTags(line.tags) : (line.experiment ?? ownKey(line));
    groups.set(key, [...(groups.get(key) ?? []), line]);
  }
  return [...groups].map(([key, runs]) => ({key, runs}));
}

const OWN = 'own ';

/** The group of a run that follows no experiment of the library: that of its plant. @param {service.RunLine} line */
const ownKey = ({kind, plant}) => (kind === 'record' || !plant ? '' : OWN + plant);

/** Tags as the server writes them. @param {string[]} tags */
const keyOfTags = (tags) => (tags.length ? `[${tags.map((tag) => JSON.stringify(tag)).join(', ')}]` : '[]');

/**
 * @param {string} key
 * @param {service.RunGroup | undefined} found
 * @param {service.RunLine[]} runs
 * @param {string} group
 */
function groupRow(key, found, runs, group) {
  const title =
    group === 'tags'
      ? found?.title || runs[0].tags.join(', ') || t('page.notebook.no-tags')
      : found?.title || (key && named(runs[0].title)) || t('page.notebook.no-experiment');
  const n = Math.max(found?.n ?? 0, runs.length);
  const count =
    runs.length < n ? t('page.notebook.group-part', {shown: runs.length, n}) : t('page.notebook.group-runs', {n});
  return h(
    'tr',
    {class: 'group'},
    h(
      'th',
      {colspan: COLUMNS.length + 3, scope: 'rowgroup'},
      h('b', {}, title),
      ' ',
      group === 'experiment' && key.replace(OWN, ''),
      key && group === 'experiment' && ' · ',
      count,
    ),
  );
}

/** @param {service.RunLine} line @param {NotebookState} state @param {NotebookActions} act */
function row(line, state, act) {
  const name = nameOf(line);
  const chosen = state.chosen.has(line.id);
  const active = ACTIVE.has(line.status);
  const tick = h('input', {
    type: 'checkbox',
    'aria-label': t('page.notebook.choose', {name}),
    'data-key': `tick-${line.id}`,
    onchange: () => act.tick(line.id),
  });
  tick.checked = chosen;
  tick.disabled = active;
  return h(
    'tr',
    {
      class: [chosen && 'picked', line.id === state.cursor && 'cursor'].filter(Boolean).join(' ') || null,
      'data-run': line.id,
      onclick: (/** @type {MouseEvent} */ event) => act.pressed(line.id, event),
    },
    h('td', {class: 'tick'}, tick),
    h('td', {class: 'pin'}, star(line, name, act)),
    h(
      'td',
      {class: 'c-name'},
      h('a', {href: addressOfRun(line), 'data-key': `open-${line.id}`}, name),
      line.tags.map((tag) => h('span', {class: 'tag'}, tag)),
      line.warning && h('small', {class: 'alarm', role: 'note'}, line.warning),
      state.filter.group !== 'experiment' && h('small', {}, named(line.title)),
    ),
    h('td', {class: 'c-changes'}, changesOf(line)),
    h('td', {class: 'c-curve'}, sparkline(line.curve)),
    h(
      'td',
      {
        class: 'r c-rmse',
        title: line.state && t('page.notebook.of-state', {state: plain(line.state), observer: line.observer ?? ''}),
      },
      number(line.rmse, 3),
    ),
    h(
      'td',
      {class: `r c-delay${line.delay === null ? ' none' : ''}`},
      line.delay === null ? '–' : `${number(line.delay, 3)} s`,
    ),
    h('td', {class: `r c-false-alarms${line.false_alarms ? ' alarm' : ''}`}, alarms(line)),
    h(
      'td',
      {class: 'r c-when'},
      active ? status(line) : whenOf(line.created),
      line.status !== 'done' && !active && h('small', {class: 'alarm'}, t(`page.notebook.status.${line.status}`)),
    ),
    h('td', {class: 'more'}, line.mine && !active && menu(line, name, act)),
  );
}

/** @param {service.RunLine} line */
const status = (line) =>
  line.status === 'running'
    ? t('page.notebook.status.running', {percent: Math.floor(100 * line.progress)})
    : t('page.notebook.status.queued');

/** @param {service.RunLine} line */
function alarms({false_alarms: n}) {
  if (n === null) return '–';
  return [String(n), h('span', {class: 'on-card'}, ' ', t('page.notebook.false-alarms', {n}))];
}

/** @param {service.RunLine} line @param {string} name @param {NotebookActions} act */
const star = (line, name, act) =>
  h(
    'button',
    {
      type: 'button',
      class: 'star',
      'aria-pressed': String(line.pinned),
      'aria-label': t('page.notebook.pin', {name}),
      title: t('page.notebook.pin.hint'),
      'data-key': `pin-${line.id}`,
      disabled: !line.mine || ACTIVE.has(line.status),
      onclick: () => act.pin([line.id], !line.pinned),
    },
    h('svg', {viewBox: '0 0 16 16', width: 15, height: 15, 'aria-hidden': 'true'}, h('path', {d: STAR})),
  );

const STAR = 'M8 1.2l2.1 4.4 4.8.6-3.5 3.3.9 4.8L8 12l-4.3 2.3.9-4.8L1.100 6.200l4.800-.6z';

/** @param {service.RunLine} line @param {string} name @param {NotebookActions} act */
const menu = (line, name, act) =>
  h(
    'button',
    {
      type: 'button',
      class: 'dots3',
      'aria-label': t('page.notebook.edit', {name}),
      title: t('page.notebook.edit.hint'),
      'data-key': `edit-${line.id}`,
      onclick: () => act.edit(line),
    },
    '⋯',
  );

/** @param {NotebookState} state */
function emptyWords({loaded, counts}) {
  if (!loaded) return h('p', {class: 'soft'}, t('page.text.loading'));
  if (counts.all === 0)
    return [h('h2', {}, t('page.notebook.empty')), h('p', {class: 'soft'}, t('page.notebook.empty.hint'))];
  return h('p', {class: 'soft'}, t('page.notebook.nothing-found'));
}

/** The key of the element with the focus. @param {HTMLElement} table */
const focusOf = (table) =>
  table.contains(document.activeElement) ? document.activeElement?.getAttribute('data-key') : null;

/** @param {HTMLElement} table @param {string | null | undefined} key */
function restoreFocus(table, key) {
  const element = key ? table.querySelector(`[data-key="${CSS.escape(key)}"]`) : null;
  if (element instanceof HTMLElement) element.focus({preventScroll: true});
}
