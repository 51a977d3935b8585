// A page for each paper: its claim, equations, figures beside computed ones, numbers, and errata with their evidence.

import {connection, get, reason} from '../../../common/api.js';
import {fill, h, query} from '../../../common/dom.js';
import {mountTop} from '../../../common/page-header.js';
import {chosenLanguage} from '../../../i18n/language.js';
import {named, speak, t} from '../../../i18n/words.js';
import {assumptions} from '../../../widgets/checks.js';
import {mathml} from '../../../widgets/equations.js';
import {withSymbols} from '../../../widgets/prose.js';
import {errataTable} from './errata.js';
import {figureCards} from './figures.js';
import {numbersTable} from './numbers.js';
import {resultOf} from './results.js';

/** @import {Child} from '../../../types/dom.js' */
/** @import * as service from '../../../types/service.js' */

await speak(chosenLanguage());
const {papers} = /** @type {service.PaperList} */ (await get('/api/papers'));
const wanted = new URLSearchParams(location.search).get('paper') ?? papers[0].id;
/** @type {service.PaperPage | null} */
let page = null;
/** @type {unknown} */
let refused = null;
try {
  page = await get(`/api/papers/${encodeURIComponent(wanted)}`);
} catch (error) {
  refused = error;
}

function draw() {
  fill(query('.skip'), t('page.papers.skip'));
  const title = page ? named(page.paper.citation.title) : t('page.papers.title');
  document.title = `${title} · Thetascope`;
  fill(
    query('#main'),
    h('div', {class: 'papers-side'}, chooser(), page && [summary(page.paper), contents()]),
    page
      ? h('div', {class: 'papers-work'}, work(page))
      : h('p', {class: 'card alarm', role: 'alert'}, reason(refused).message),
  );
}
mountTop(query('header'), connection, 'learn', draw);
draw();
if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();

/** The papers to choose from. */
function chooser() {
  return h(
    'nav',
    {class: 'card papers-list', 'aria-label': t('page.papers.title')},
    h('a', {href: '/learn/', class: 'soft'}, t('page.papers.back')),
    h('h2', {}, t('page.papers.title')),
    papers.map(({id, citation}) =>
      h(
        'a',
        {href: `?paper=${encodeURIComponent(id)}`, 'aria-current': id === page?.paper.id ? 'page' : null},
        h('b', {}, named(citation.authors)),
        h('span', {class: 'soft'}, named(citation.title)),
      ),
    ),
  );
}

/** What is said about a paper: its claim, how it is read, what holds. @param {service.Paper} paper */
function summary({claim, reading, holds, fails}) {
  /** @param {string} title @param {readonly service.Words[]} sentences @param {string} mark */
  const list = (title, sentences, mark) =>
    sentences.length > 0 && [
      h('h2', {}, title),
      h(
        'ul',
        {class: 'papers-verdicts'},
        sentences.map((one) => h('li', {class: mark}, withSymbols(named(one)))),
      ),
    ];
  return [
    h(
      'section',
      {class: 'card'},
      h('h2', {}, t('page.papers.claim')),
      h('p', {class: 'papers-claim'}, withSymbols(named(claim))),
      h('h2', {}, t('page.papers.reading')),
      h('p', {}, withSymbols(named(reading))),
    ),
    h(
      'section',
      {class: 'card'},
      list(t('page.papers.holds'), holds, 'holds'),
      list(t('page.papers.fails'), fails, 'fails'),
    ),
  ];
}

/** The parts of the page; it stays in sight. */
function contents() {
  const parts = /** @type {const} */ (['equations', 'numbers', 'errata', 'figures', 'checks']);
  return h(
    'nav',
    {class: 'card papers-contents', 'aria-label': t('page.papers.contents')},
    h('h2', {}, t('page.papers.contents')),
    parts.map((id) => h('a', {href: `#${id}`}, titles()[id])),
  );
}

function titles() {
  return {
    equations: t('page.papers.equations'),
    numbers: t('page.papers.numbers'),
    errata: t('page.papers.errata'),
    figures: t('page.papers.figures'),
    checks: t('page.papers.checks'),
  };
}

/** @param {service.PaperPage} page @returns {Child[]} */
function work({paper, equations}) {
  const {id, citation} = paper;
  const experiment = encodeURIComponent(id);
  return [
    h(
      'section',
      {class: 'card papers-head'},
      h('div', {}, h('h1', {}, named(citation.title)), h('p', {class: 'soft'}, named(citation.authors))),
      h('p', {class: 'soft'}, named(citation.journal)),
      h(
        'p',
        {class: 'papers-actions'},
        h('a', {class: 'run', href: `/?experiment=${experiment}`}, t('page.papers.live')),
        h('a', {class: 'quiet', href: `/runs/?experiment=${experiment}`}, t('page.papers.run')),
      ),
    ),
    section('equations', equationList(paper, equations)),
    section('numbers', h('p', {class: 'soft'}, t('page.papers.numbers.say')), [numbersTable(paper.numbers)]),
    section('errata', errataTable(paper.errata)),
    section('figures', h('p', {class: 'soft'}, t('page.papers.figures.say')), [figureCards(paper.figures)]),
    section('checks', h('p', {class: 'soft'}, t('page.papers.checks.say')), checks(id)),
  ];
}

/** @param {keyof ReturnType<typeof titles>} id @param {...Child} body */
function section(id, ...body) {
  return h('section', {class: 'card', id}, h('h2', {}, titles()[id]), body);
}

/** @param {service.Paper} paper @param {readonly string[]} texts */
function equationList(paper, texts) {
  return h(
    'ol',
    {class: 'papers-equations'},
    paper.equations.map(({number, about}, place) =>
      h(
        'li',
        {},
        h('p', {class: 'soft'}, about ? withSymbols(named(about)) : ''),
        h(
          'div',
          {class: 'papers-formula', tabindex: 0, role: 'group', 'aria-label': number || t('page.papers.equations')},
          mathml(texts[place]),
        ),
        h('span', {class: 'papers-number'}, number),
      ),
    ),
  );
}

/** The checks of the paper's own experiment, when it is computed. @param {string} id */
function checks(id) {
  const list = h('div', {class: 'papers-checks'}, h('p', {class: 'soft', role: 'status'}, t('page.papers.computing')));
  resultOf(id).then(
    (run) => fill(list, (run.summary?.observers ?? []).map(assumptions)),
    (error) => fill(list, h('p', {class: 'alarm'}, reason(error).message)),
  );
  return list;
}
