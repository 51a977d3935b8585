// Two to six runs compared: curves overlaid or less the first, settings that differ, measures, notes, and a figure for
// a paper.

import {connection, get, Problem, reason} from '../../../common/api.js';
import {fill, h, query} from '../../../common/dom.js';
import {mountTop} from '../../../common/page-header.js';
import {problemBlock} from '../../../common/problem.js';
import {segments} from '../../../widgets/paper/paper-fields.js';
import {openPaper} from '../../../widgets/paper/paper-dialog.js';
import {drawFigure} from '../figures.js';
import {addressOfRun, nameOf} from '../notebook/line-words.js';
import {chosenLanguage} from '../../../i18n/language.js';
import {named, speak, t} from '../../../i18n/words.js';
import {addressOf, paperOf, queryOf, readChoice} from './choice.js';
import {createNotes} from './notes.js';
import {createMeasures, differences, swatch} from './tables.js';

/** @import * as service from '../../../types/service.js' */
/** @import {PlotlyFigure} from '../../../types/globals.js' */

await speak(chosenLanguage());
let choice = readChoice(location.search);

/** @param {service.RunComparison} found */
function chips({runs}) {
  const {ids} = choice;
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
              href: addressOf({...choice, ids: ids.filter((id) => id !== run.id)}),
              'aria-label': t('page.compare.without', {name: nameOf(run)}),
            },
            '×',
          ),
      ),
    ),
  );
}

document.title = `${t('page.notebook.compare')} · Thetascope`;
document.body.classList.add('comparing');
query('.skip').textContent = t('page.nav.skip-to-figures');
mountTop(query('.top'), connection);
const main = query('main');
const bar = h('section', {class: 'notebook-bar'});
const plot = h('div', {class: 'plot'});
const legend = h('p', {class: 'soft small'});
const tools = h('div', {class: 'curve-tools'});
const curves = h(
  'section',
  {class: 'card compare-curves'},
  h('div', {class: 'heading'}, h('h2', {}, t('page.compare.figure')), tools),
  legend,
  plot,
);
const settings = h('section', {class: 'card'});
const measuresCard = h('section', {class: 'card compare-measures'});
const measures = createMeasures(measuresCard);
const notesCard = h('section', {class: 'card compare-notes'});
main.before(bar);

/** @param {string} title */
const paper = (title) =>
  h(
    'button',
    {type: 'button', class: 'run', onclick: () => openPaper(...paperOf(choice, title))},
    t('page.paper.open'),
  );

/** @param {Partial<typeof choice>} changes */
function choose(changes) {
  choice = {...choice, ...changes};
  history.replaceState(null, '', addressOf(choice));
  return load().catch(trouble);
}

/** @param {service.RunComparison} found */
function showTools({choices, observers}) {
  const common = observers.every((label) => label === observers[0]) ? observers[0] : null;
  fill(
    tools,
    choices.length > 1 &&
      h(
        'select',
        {
          'aria-label': t('page.compare.observer'),
          onchange: ({currentTarget}) => choose({observer: currentTarget.value}),
        },
        choice.observer === '' &&
          common === null &&
          h('option', {value: '', selected: true}, t('page.compare.observer.first')),
        choices.map((label) => h('option', {value: label, selected: label === (choice.observer || common)}, label)),
      ),
    segments(
      t('page.compare.curves'),
      [
        ['', t('page.compare.overlaid')],
        ['less', t('page.compare.less')],
      ],
      choice.less ? 'less' : '',
      (value) => choose({less: value === 'less'}),
    ),
  );
}

const AGAIN = 1000; // ms

/**
 * An answer that needs results; while one that the store has dropped is computed again, the page says so and waits.
 * @template Answer
 * @param {string} path
 * @param {AbortSignal} [signal]
 * @returns {Promise<Answer>}
 */
async function patiently(path, signal) {
  for (;;) {
    try {
      return await get(path, signal);
    } catch (error) {
      if (!(error instanceof Problem) || error.code !== 'run.not-done') throw error;
      fill(plot.isConnected ? plot : main, h('p', {class: 'soft busy', role: 'status'}, t('page.compare.again')));
      await new Promise((done) => setTimeout(done, AGAIN));
    }
  }
}

/** @type {AbortController | null} */
let drawing = null;
async function draw() {
  drawing?.abort();
  const mine = (drawing = new AbortController());
  const theme = window.theme.now;
  /** @type {PlotlyFigure} */
  const figure = await patiently(`/api/runs/compare/figure?${queryOf(choice)}&theme=${theme}`, mine.signal);
  if (mine.signal.aborted) return;
  fill(legend, named(figure.layout.meta?.caption));
  await drawFigure(plot, figure);
  plot.dataset.drawn = `${addressOf(choice)} ${theme}`;
}
const redraw = () =>
  draw().catch((error) => {
    if (error?.name !== 'AbortError') trouble(error);
  });

async function load() {
  /** @type {service.RunComparison} */
  const found = await patiently(`/api/runs/compare?${queryOf(choice)}`);
  const titles = [...new Set(found.runs.map((run) => named(run.title)))];
  const title = t('page.compare.title', {n: found.runs.length});
  if (!curves.isConnected) {
    fill(
      bar,
      h('div', {class: 'bar-name'}, h('h1', {}, title), h('small', {class: 'soft'}, titles.join(' · '))),
      chips(found),
      h(
        'div',
        {class: 'bar-actions'},
        paper(title),
        h('a', {class: 'quiet', href: '/runs/'}, t('page.notebook.all-runs')),
      ),
    );
    fill(settings, differences(found));
    createNotes(notesCard, choice.ids, found.notes, found.warning);
    fill(main, curves, h('div', {class: 'compare-cards'}, settings, measuresCard, notesCard));
  }
  showTools(found);
  measures.show(found);
  await redraw();
}

/** @param {unknown} error */
function trouble(error) {
  const block = problemBlock(error instanceof Problem ? error : new Problem({title: reason(error).message}));
  if (plot.isConnected) fill(plot, block);
  return block;
}

addEventListener('theme', redraw);
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;
addEventListener('resize', () => {
  clearTimeout(timer);
  timer = setTimeout(redraw, 150);
});
await load().catch((error) => fill(main, h('div', {class: 'card'}, trouble(error))));
