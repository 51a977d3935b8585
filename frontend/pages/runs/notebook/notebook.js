// The notebook of runs: loads the list, keeps what is chosen, and has the actions of the views.

import {connection, get, Problem, post, reason, request} from '../../../common/api.js';
import {fill, h, query} from '../../../common/dom.js';
import {mountTop} from '../../../common/page-header.js';
import {problemBlock} from '../../../common/problem.js';
import {createBar, createShelf} from './filters.js';
import {addressOf, readFilter, requestOf} from './filter.js';
import {createTable} from './table.js';
import {askDelete, askNotes, askTags, createNotice, createTray, FEWEST, MOST} from './tray.js';
import {chosenLanguage} from '../../../i18n/language.js';
import {speak, t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Filter} from './filter.js' */

/**
 * @typedef {object} NotebookState
 * @property {Filter} filter
 * @property {service.RunLine[]} lines
 * @property {service.RunGroup[]} groups
 * @property {service.RunTag[]} tags
 * @property {service.RunCounts} counts
 * @property {Set<string>} chosen   ids, in the order in which they were chosen
 * @property {string | null} cursor   id of the row that the keys act on
 * @property {boolean} more   whether the server has more runs of this filter
 * @property {number} reached   how many of the server's stored runs were loaded
 * @property {boolean} loaded
 */

/**
 * @typedef {object} NotebookActions
 * @property {(changes: Partial<Filter>) => unknown} filter
 * @property {(field: string) => unknown} sort
 * @property {() => unknown} more
 * @property {(id: string) => void} tick
 * @property {(id: string, event: MouseEvent) => void} pressed
 * @property {() => void} chooseNone
 * @property {(ids: string[], pinned: boolean) => unknown} pin
 * @property {(line: service.RunLine) => unknown} edit
 * @property {(lines: service.RunLine[]) => unknown} tag
 * @property {(lines: service.RunLine[]) => unknown} remove
 * @property {() => void} compare
 */

const PAGE = 100;
const AGAIN_MS = 2000;
const phone = matchMedia('(max-width: 719px)');

await speak(chosenLanguage());

/** @type {NotebookState} */
let state = {
  filter: readFilter(location.search),
  lines: [],
  groups: [],
  tags: [],
  counts: {all: 0, pinned: 0, kinds: {}, found: 0},
  chosen: new Set(),
  cursor: null,
  more: false,
  reached: 0,
  loaded: false,
};
let asked = 0;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let again;

/** @type {NotebookActions} */
const act = {
  filter(changes) {
    state = {...state, filter: {...state.filter, ...changes}};
    history.replaceState(null, '', addressOf(state.filter));
    show();
    return load();
  },
  sort(field) {
    const {sort, descending} = state.filter;
    act.filter({sort: field, descending: sort === field ? !descending : field === 'created'});
  },
  more: () => load(true),
  tick(id) {
    const chosen = new Set(state.chosen);
    if (!chosen.delete(id)) chosen.add(id);
    state = {...state, chosen, cursor: id};
    show();
  },
  pressed(id, event) {
    const inside = event.target instanceof Element && event.target.closest('a, button, input');
    if (!inside && phone.matches && !query(`[data-run="${id}"] input`).hasAttribute('disabled')) act.tick(id);
  },
  chooseNone() {
    state = {...state, chosen: new Set()};
    show();
  },
  pin: (ids, pinned) => guarded(() => changed(ids, () => ({pinned}))),
  async edit(line) {
    const notes = await askNotes(line);
    if (notes) await guarded(() => changed([line.id], () => notes));
  },
  async tag(lines) {
    const tags = await askTags(lines.length);
    const of = Object.fromEntries(lines.map((line) => [line.id, line.tags]));
    if (tags?.length)
      await guarded(() => changed(Object.keys(of), (id) => ({tags: [...new Set([...of[id], ...tags])]})));
  },
  async remove(lines) {
    if (!(await askDelete(lines))) return;
    const ids = lines.map((line) => line.id);
    await guarded(async () => {
      for (const id of ids) await request('DELETE', `/api/runs/${id}`);
      state = {...state, chosen: new Set([...state.chosen].filter((id) => !ids.includes(id)))};
      notice.tell(t('page.notebook.deleted', {n: ids.length}), () =>
        guarded(async () => {
          for (const id of ids) await post(`/api/runs/${id}/restore`);
          await load();
        }),
      );
    });
    await load();
  },
  compare() {
    const {size} = state.chosen;
    if (size >= FEWEST && size <= MOST) location.assign(`/runs/?compare=${[...state.chosen].join(',')}`);
  },
};

/**
 * Change what the owner notes about runs.
 * @param {string[]} ids
 * @param {(id: string) => service.RunNotes} notes
 */
async function changed(ids, notes) {
  for (const id of ids) await request('PATCH', `/api/runs/${id}`, {body: notes(id)});
  await load();
}

/**
 * Load the runs of the filter, or the next page of them.
 * @param {boolean} [next]
 */
async function load(next = false) {
  clearTimeout(again);
  const mine = ++asked;
  await guarded(async () => {
    const offset = next ? state.reached : 0;
    const limit = next ? PAGE : Math.max(PAGE, Math.min(state.reached, 1000));
    /** @type {service.RunList} */
    const {runs, groups, tags, counts} = await get(requestOf(state.filter, limit, offset));
    if (mine !== asked) return;
    const lines = next ? [...state.lines, ...runs] : runs;
    const there = new Set(lines.map((line) => line.id));
    const active = lines.some((line) => line.status === 'queued' || line.status === 'running');
    state = {
      ...state,
      ...{lines, groups, tags, counts, loaded: true},
      reached: offset + limit,
      more: offset + limit < counts.found,
      chosen: new Set([...state.chosen].filter((id) => there.has(id))),
    };
    if (active) again = setTimeout(load, AGAIN_MS);
    fill(trouble);
    show();
  });
}

/** @param {() => Promise<unknown>} work */
async function guarded(work) {
  try {
    await work();
  } catch (error) {
    const problem = error instanceof Problem ? error : new Problem({title: reason(error).message});
    fill(trouble, problemBlock(problem));
  }
}

/** The keys: / find, j k move, x tick, p pin, C compare. @param {KeyboardEvent} event */
function pressed(event) {
  const typing =
    event.target instanceof Element && event.target.closest('input:not([type="checkbox"]), select, dialog');
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const place = state.lines.findIndex((line) => line.id === state.cursor);
  const line = state.lines[place];
  /** @type {{[key: string]: () => unknown}} */
  const keys = {
    '/': () => bar.search.focus(),
    j: () => move(Math.min(place + 1, state.lines.length - 1)),
    k: () => move(Math.max(place - 1, 0)),
    x: () => line && act.tick(line.id),
    p: () => line?.mine && act.pin([line.id], !line.pinned),
    c: act.compare,
    C: act.compare,
  };
  if (!Object.hasOwn(keys, event.key)) return;
  event.preventDefault();
  keys[event.key]();
}

/** @param {number} place */
function move(place) {
  state = {...state, cursor: state.lines[place]?.id ?? null};
  show();
  document.querySelector('.runs-table .cursor')?.scrollIntoView({block: 'nearest'});
}

function show() {
  for (const view of [bar, shelf, table, tray]) view.show(state);
}

document.title = `${t('page.nav.runs')} · Thetascope`;
query('.skip').textContent = t('page.notebook.skip');
mountTop(query('.top'), connection);
const trouble = h('div', {class: 'trouble'});
const parts = {
  bar: h('section', {class: 'notebook-bar'}),
  shelf: h('nav', {class: 'shelf'}),
  card: h('section', {class: 'card runs-card'}),
  tray: h('section', {class: 'tray', hidden: true}),
  notice: h('div', {class: 'tray notice', role: 'status', hidden: true}),
};
const main = query('main');
fill(main, trouble, parts.card);
main.before(parts.bar, parts.shelf);
main.after(parts.tray, parts.notice);
const bar = createBar(parts.bar, act);
const shelf = createShelf(parts.shelf, act);
const table = createTable(parts.card, act, bar.columns);
const tray = createTray(parts.tray, act);
const notice = createNotice(parts.notice);
addEventListener('keydown', pressed);
show();
await load();
