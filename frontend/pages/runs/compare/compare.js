// Two to six runs compared: curves overlaid, settings that differ, measures to sort by.

import {connection, get, Problem, reason} from '../../../common/api.js';
import {fill, h, number, query} from '../../../common/dom.js';
import {mountTop} from '../../../common/page-header.js';
import {problemBlock} from '../../../common/problem.js';
import {drawFigure} from '../figures.js';
import {addressOfRun, labelOf, nameOf, valueOf} from '../notebook/line-words.js';
import {chosenLanguage} from '../../../i18n/language.js';
import {named, speak, t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */
/** @import {PlotlyFigure} from '../../../types/globals.js' */

await speak(chosenLanguage());
const ids = (new URLSearchParams(location.search).get('compare') ?? '').split(',');
/** @type {number | null} the measure by which runs are sorted */
let sorted = null;

/** The address of a comparison of other runs. @param {string[]} others */
const addressOf = (others) => (others.length > 1 ? `/runs/?compare=${others.join(',')}` : '/runs/');

/** @param {number} place */
const swatch = (place) => h('span', {class: 'swatch', style: `background:var(--o${place})`, 'aria-hidden': 'true'});

/** @param {service.RunComparison} found */
function chips({runs}) {
  return h(
    'ul',
    {class: 'compared'},
    runs.map((run, place) =>
      h(
        'li',
        {},
        swatch(place),
        h('a', {href: addressOfRun(run)}, nameOf(run)),
        runs.length > 2 &&
          h(
            'a',
            {
              class: 'off',
              href: addressOf(ids.filter((id) => id !== run.id)),
              'aria-label': t('page.compare.without', {name: nameOf(run)}),
            },
            '×',
          ),
      ),
    ),
  );
}

/** @param {service.RunComparison} found */
function differences({runs, differences: rows, same}) {
  const table = h(
    'table',
    {class: 'compare-table'},
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('th', {}, t('page.compare.setting')),
        runs.map((run, place) =>
          h('th', {class: 'r', title: nameOf(run)}, swatch(place), h('span', {class: 'unseen'}, nameOf(run))),
        ),
      ),
    ),
    h(
      'tbody',
      {},
      rows.map(({label, values}) =>
        h(
          'tr',
          {},
          h('th', {}, labelOf(label)),
          values.map((value) =>
            h('td', {class: `r${value === values[0] ? '' : ' other'}`}, h('span', {}, valueOf(value) || '–')),
          ),
        ),
      ),
    ),
  );
  return [
    h('h2', {}, t('page.compare.differs')),
    rows.length > 0 && h('div', {class: 'wide', tabindex: 0}, table),
    h('p', {class: 'soft small'}, rows.length ? t('page.compare.same', {n: same}) : t('page.compare.all-same')),
  ];
}

/** @param {HTMLElement} root @param {service.RunComparison} found */
function showMeasures(root, found) {
  const {runs, measures, observers} = found;
  const key = sorted === null ? null : measures[sorted].values;
  const order = runs.map((_, place) => place);
  if (key) order.sort((a, b) => (key[a] ?? Infinity) - (key[b] ?? Infinity));
  const best = measures.map(({values}) => {
    const known = values.filter((value) => value !== null);
    return known.length > 1 && Math.max(...known) > Math.min(...known) ? Math.min(...known) : null;
  });
  const table = h(
    'table',
    {class: 'compare-table'},
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('th', {}, t('page.compare.run')),
        measures.map(({label}, place) =>
          h(
            'th',
            {class: 'r', 'aria-sort': sorted === place ? 'ascending' : null},
            h(
              'button',
              {type: 'button', onclick: () => sortBy(root, found, place)},
              labelOf(label),
              sorted === place && ' ↑',
            ),
          ),
        ),
      ),
    ),
    h(
      'tbody',
      {},
      order.map((run) =>
        h(
          'tr',
          {},
          h('th', {}, swatch(run), ' ', nameOf(runs[run]), observers[run] && h('small', {}, ' ', observers[run])),
          measures.map(({unit, values}, place) => {
            const text = values[run] === null ? '–' : `${number(values[run], 3)}${unit && ` ${unit}`}`;
            return h('td', {class: 'r'}, values[run] !== null && values[run] === best[place] ? h('b', {}, text) : text);
          }),
        ),
      ),
    ),
  );
  fill(
    root,
    h('h2', {}, t('page.compare.measures')),
    h('div', {class: 'wide', tabindex: 0}, table),
    h('p', {class: 'soft small'}, t('page.compare.measures.hint')),
  );
}

/** @param {HTMLElement} root @param {service.RunComparison} found @param {number} place */
function sortBy(root, found, place) {
  sorted = sorted === place ? null : place;
  showMeasures(root, found);
  const button = root.querySelectorAll('thead button')[place];
  if (button instanceof HTMLElement) button.focus();
}

document.title = `${t('page.notebook.compare')} · Thetascope`;
document.body.classList.add('comparing');
query('.skip').textContent = t('page.nav.skip-to-figures');
mountTop(query('.top'), connection);
const main = query('main');
const bar = h('section', {class: 'notebook-bar'});
const plot = h('div', {class: 'plot'});
const curves = h('section', {class: 'card compare-curves'}, h('h2', {}, t('page.compare.figure')), plot);
const settings = h('section', {class: 'card'});
const measures = h('section', {class: 'card compare-measures'});
main.before(bar);
try {
  /** @type {service.RunComparison} */
  const found = await get(`/api/runs/compare?${new URLSearchParams({ids: ids.join(',')})}`);
  const titles = [...new Set(found.runs.map((run) => named(run.title)))];
  fill(
    bar,
    h(
      'div',
      {class: 'bar-name'},
      h('h1', {}, t('page.compare.title', {n: found.runs.length})),
      h('small', {class: 'soft'}, titles.join(' · ')),
    ),
    chips(found),
    h('div', {class: 'bar-actions'}, h('a', {class: 'quiet', href: '/runs/'}, t('page.notebook.all-runs'))),
  );
  fill(settings, differences(found));
  showMeasures(measures, found);
  fill(main, curves, h('div', {class: 'compare-cards'}, settings, measures));
  const draw = async () => {
    /** @type {PlotlyFigure} */
    const figure = await get(`${found.links.figure}&theme=${window.theme.now}`);
    await drawFigure(plot, figure);
  };
  const redraw = () => draw().catch(trouble);
  addEventListener('theme', redraw);
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  addEventListener('resize', () => {
    clearTimeout(timer);
    timer = setTimeout(redraw, 150);
  });
  await redraw();
  plot.dataset.drawn = '';
} catch (error) {
  fill(main, h('div', {class: 'card'}, trouble(error)));
}

/** @param {unknown} error */
function trouble(error) {
  const block = problemBlock(error instanceof Problem ? error : new Problem({title: reason(error).message}));
  if (plot.isConnected) fill(plot, block);
  return block;
}
