// The table that compares the observers over the window that the scope shows; in a fork with those of the session that
// it came from.

import {childrenOf, fill, h, hatted, symbol} from '../../../common/dom.js';
import {badges, called, plain, split, symbolic, titleOf} from '../../../common/names.js';
import {get} from '../../../common/api.js';
import {Form} from './column-format.js';
import {detected, figuresOf} from './compare-observer.js';
import {ascending, best, sortButton} from '../../../widgets/ordering.js';
import {wholeLines} from '../../../widgets/whole-lines.js';
import {chip, heading, link} from '../../../widgets/controls.js';
import {kindName} from '../../../widgets/kind-name.js';
import {t} from '../../../i18n/words.js';

/** @import {App, ObserverState} from '../../types.js' */
/** @import {Figure} from './compare-observer.js' */
/** @import * as service from '../../../types/service.js' */

/** @typedef {{name: string, title?: string, description?: string}} Named   a state or channel */

const EVERY = 1000; // ms between two requests
const LONGEST = 6000; // rows of a window of "all"

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  /** @type {string | null} chosen by hand */
  let state = null;
  /** @type {string | null} chosen by hand */
  let channel = null;
  /**
   * @type {{
   *   row: HTMLElement, cells: HTMLElement[], session: 'mine' | 'parent',
   *   of: (answer: service.WindowComparison) => Figure[], observer: boolean
   * }[]}
   */
  let rows = [];
  /** @type {number | null} the column by which rows are sorted */
  let sorted = null;
  /** @type {{mine: service.WindowComparison | null, parent: service.WindowComparison | null}} */
  let latest = {mine: null, parent: null};
  /** @type {Form[]} */
  let forms = []; // how the numbers of each column are written
  let last = 0;
  /** @type {ReturnType<typeof setTimeout> | 0} */
  let late = 0;
  let asking = 0; // number of the newest request: answers to earlier ones are dropped
  const body = h('tbody');
  const scroll = h('div', {class: 'scroll'});
  const more = wholeLines(scroll, () => childrenOf(body), app);

  const build = () => {
    const {plant, observers, origin} = app.state;
    element.hidden = !plant || observers.length === 0;
    if (!plant || element.hidden) return;
    const [x, theta] = chosen();
    const head = h(
      'tr',
      {},
      h('td'),
      h(
        'th',
        {scope: 'col', title: t('page.comparison.rmse.hint')},
        sorter(0, 'RMSE'),
        ' ',
        picker(
          plant.states,
          x,
          t('page.comparison.state'),
          (name) => {
            state = name;
            build();
          },
          app,
        ),
      ),
      theta &&
        h(
          'th',
          {scope: 'col', title: t('page.comparison.settle.hint')},
          sorter(1, t('page.comparison.settle')),
          ' ',
          picker(
            plant.channels,
            theta,
            t('page.comparison.fault'),
            (name) => {
              channel = name;
              build();
            },
            app,
          ),
        ),
      theta &&
        h(
          'th',
          {scope: 'col', title: t('page.comparison.noise.hint')},
          sorter(2, t('page.comparison.noise')),
          ' ',
          short(theta, plant.channels, app, true),
        ),
    );
    rows = [];
    const mine = group(observers, 'mine');
    const first =
      origin &&
      group(
        origin.observers.map((one) => ({
          ...one,
          colour: observers.find(({label}) => label === one.label)?.colour ?? one.colour,
        })),
        'parent',
      );
    fill(
      body,
      mine,
      first && [
        h(
          'tr',
          {class: 'origin'},
          h(
            'th',
            {scope: 'rowgroup', colspan: 4},
            link(t('page.scope.parent'), () => app.act.visit(app.state.parent?.id ?? ''), {
              title: t('page.scope.parent.hint'),
            }),
          ),
        ),
        first.map((row) => {
          row.classList.add('of-origin');
          return row;
        }),
      ],
    );
    fill(
      scroll,
      h('table', {}, h('caption', {class: 'visually-hidden'}, t('page.comparison.title')), h('thead', {}, head), body),
    );
    const open = link(t('page.comparison.full'), () => app.act.table(true), {
      'data-open': 'table',
      title: t('page.comparison.full.hint'),
    });
    fill(element, heading(t('page.comparison.title'), open), scroll, more);
    forms = [new Form(), new Form(), new Form()];
    compute();
  };
  /**
   * @param {number} place
   * @param {string} words
   */
  const sorter = (place, words) =>
    sortButton({
      words,
      name: words,
      sorted: sorted === place,
      act: () => {
        sorted = sorted === place ? null : place;
        build();
        show(latest);
        [...element.querySelectorAll('.sort')].filter((one) => one instanceof HTMLElement)[place]?.focus();
      },
    });
  /**
   * The rows of one session: one an observer, and how soon its detector found the fault.
   * @param {ObserverState[]} observers
   * @param {'mine' | 'parent'} session
   */
  const group = (observers, session) => {
    const [, theta] = chosen();
    const cell = () => h('td');
    const observerRows = observers.map(({label, colour, dashed, kind}) => {
      const cells = theta ? [cell(), cell(), cell()] : [cell()];
      const row = h(
        'tr',
        {},
        h(
          'th',
          {scope: 'row', title: `${label}, ${kindName({id: kind, title: kind})}`},
          h('span', {class: 'who'}, chip(colour, dashed), h('span', {}, label)),
        ),
        cells,
      );
      /** @param {service.WindowComparison} answer */
      const of = (answer) => figuresOf(answer, label, span()[1], app.state.record);
      rows.push({row, cells, session, of, observer: true});
      return row;
    });
    if (!theta || !app.state.diagnosis || app.state.diagnosis.note) return observerRows;
    const delayCell = cell();
    const row = h(
      'tr',
      {class: 'detector', title: t('page.comparison.found.hint')},
      h('th', {scope: 'row', colspan: 2}, t('page.comparison.found-by')),
      delayCell,
      h('td'),
    );
    rows.push({row, cells: [delayCell], session, of: (answer) => [detected(answer)], observer: false});
    return [...observerRows, row];
  };
  /**
   * State and channel of the columns: chosen by hand, else the first state and the newest fault.
   * @returns {[string, string | null]}
   */
  const chosen = () => {
    const {plant, faults, columns} = app.state;
    if (!plant) throw new Error('there is no plant to compare observers on');
    const estimated = plant.channels.filter((one) =>
      columns.some((column) => column.endsWith(`.theta.${one.name}`) && !column.startsWith('theta.')),
    );
    const newest = faults.findLast(
      (fault) => fault.onChannel && fault.active && estimated.some((one) => one.name === fault.subject),
    );
    const x = plant.states.find((one) => one.name === state)?.name ?? plant.states[0].name;
    return [
      x,
      plant.channels.some((one) => one.name === channel) ? channel : (newest?.subject ?? estimated[0]?.name ?? null),
    ];
  };
  /** @returns {[number, number]} */
  const span = () => {
    const {t, window, selection} = app.state;
    return selection ?? [Math.max(0, t - (window ?? LONGEST * app.state.record)), t];
  };
  /** Ask the server for the figures of the window, of this session and of the one that it was forked from. */
  const compute = async () => {
    const {session, parent, origin, plant} = app.state;
    if (!plant || element.hidden || !session) return;
    const [x, theta] = chosen();
    const [from, to] = span();
    const query = new URLSearchParams({
      from: String(from),
      to: String(to),
      state: x,
      ...(theta ? {channel: theta} : {}),
    });
    const number = (asking += 1);
    /** @param {string} id @returns {Promise<service.WindowComparison | null>} */
    const ask = (id) => get(`/api/sessions/${encodeURIComponent(id)}/comparison?${query}`).catch(() => null);
    const [mine, first] = await Promise.all([ask(session), origin && parent ? ask(parent.id) : null]);
    if (number !== asking) return;
    show({mine, parent: first});
    const converging = mine?.observers.filter((one) => one.converging).map(({label}) => label) ?? [];
    if (converging.join('\n') !== app.state.converging.join('\n')) app.store.dispatch({type: 'set', converging});
  };
  /** @param {{mine: service.WindowComparison | null, parent: service.WindowComparison | null}} answers */
  const show = (answers) => {
    latest = answers;
    const filled = rows.flatMap(({of, ...row}) => {
      const answer = answers[row.session];
      return answer ? [{...row, figures: of(answer)}] : [];
    });
    arrange(
      filled.filter(({observer}) => observer),
      sorted,
    );
    forms.forEach((form, place) => form.take(filled.flatMap(({figures}) => figures[place]?.value ?? [])));
    for (const {cells, figures} of filled) {
      const known = figures.slice(0, cells.length); // without a channel the table has one column
      for (const [place, {words, value, title}] of known.entries())
        put(cells[place], words ?? forms[place].write(value ?? NaN), title);
    }
  };
  app.subscribe((s) => [s.plant, s.language, s.observers, s.columns, Boolean(s.diagnosis && !s.diagnosis.note)], build);
  app.subscribe((s) => [s.faults, s.origin], build);
  app.onTick(() => {
    late ||= setTimeout(
      () => {
        // the last of many changes counts, too
        [late, last] = [0, performance.now()];
        compute();
      },
      Math.max(0, last + EVERY - performance.now()),
    );
  });
}

/**
 * Mark the best figures of each session's observers, and put their rows in order.
 * @param {{row: HTMLElement, cells: HTMLElement[], session: string, figures: Figure[]}[]} all
 * @param {number | null} sorted   the column that orders them; null: as they were added
 */
function arrange(all, sorted) {
  for (const session of ['mine', 'parent']) {
    const own = all.filter((one) => one.session === session);
    if (own.length === 0) continue;
    own[0].cells.forEach((_, place) => {
      const first = best(own.map(({figures}) => figures[place]?.value));
      own.forEach(({cells}, row) => cells[place].classList.toggle('best', first.has(row)));
    });
    const order =
      sorted === null ? own.map((_, place) => place) : ascending(own.map(({figures}) => figures[sorted]?.value));
    const wanted = order.map((place) => own[place].row);
    const present = childrenOf(wanted[0].parentElement ?? wanted[0]).filter((row) => wanted.includes(row));
    const {nextSibling} = present[present.length - 1];
    if (wanted.some((row, place) => row !== present[place]))
      for (const row of wanted) row.parentElement?.insertBefore(row, nextSibling);
  }
}

/**
 * Set a cell; a number that has not changed is left alone.
 * @param {HTMLElement} cell
 * @param {string} words
 * @param {string} title
 */
function put(cell, words, title) {
  if (cell.textContent !== words) cell.textContent = words;
  if (cell.title !== title) cell.title = title;
}

/**
 * A name that fits the head of a column: long ones as in the badges.
 * @param {string} name
 * @param {Named[]} items
 * @param {App} app
 * @param {boolean} [hat]
 */
export function short(name, items, app, hat = false) {
  if (split(name)[0].length === 1) return symbol(name, hat);
  const [letters, index] = badges(items).get(name) ?? split(name);
  return h(
    'span',
    {class: 'math', title: called(name, app.state.plant)},
    hat ? hatted(letters) : h('i', {}, letters),
    index && h('sub', {}, index),
  );
}

/**
 * Which state or channel a column is about.
 * @param {Named[]} items
 * @param {string} chosen
 * @param {string} name
 * @param {(name: string) => void} choose
 * @param {App} app
 */
function picker(items, chosen, name, choose, app) {
  if (items.length < 2) return short(chosen, items, app);
  /** @param {Named} item */
  const title = (item) => titleOf(item);
  return h(
    'span',
    {class: 'picker'},
    short(chosen, items, app),
    h(
      'select',
      {'aria-label': name, onchange: (event) => choose(event.currentTarget.value)},
      items.map((item) =>
        h(
          'option',
          {value: item.name, selected: item.name === chosen},
          symbolic(item.name) ? `${plain(item.name)}  ${title(item)}` : title(item) || plain(item.name),
        ),
      ),
    ),
  );
}
