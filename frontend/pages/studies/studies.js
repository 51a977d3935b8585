// Studies: the form on the left, what comes out on the right while it arrives; without a study the list of them.

import {connection, get, post, reason, request} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {named, speak, t} from '../../i18n/words.js';
import {pack} from '../../live/state/permalink.js';
import {ownPlants} from '../../widgets/own-plants.js';
import {createForm} from './form.js';
import {createResults} from './results.js';

/** @import * as service from '../../types/service.js' */

const EVERY = 1500;
/** Milliseconds between two looks at a study that is computed. */

await speak(chosenLanguage());
let {experiments, observers} = /** @type {service.Catalogue} */ (await get('/api/catalogue'));
const bar = query('.study-bar');
const right = query('.study-results');
const refused = h('p', {class: 'alarm', role: 'alert'});
/** @type {service.StudyState | null} */
let state = null;
/** @type {service.StudyState[]} */
let known = [];
let begun = {at: 0, done: 0};
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

const form = createForm(query('.study-form'), {experiments, kinds: observers, own: await ownPlants()}, begin);
const results = createResults(right, {open: openRun});

/** @param {service.Study} study */
async function begin(study) {
  adopt(await post('/api/studies', study));
  history.pushState(null, '', `?study=${state?.id}`);
}

/** Show another study, or its next state. @param {service.StudyState} next */
function adopt(next) {
  if (next.id !== state?.id || next.status !== state.status) begun = {at: Date.now(), done: next.done};
  state = next;
  drawBar();
  if (next.done) results.show(next);
  else fill(right, h('p', {class: 'card soft study-empty'}, t('page.studies.waiting')));
  clearTimeout(timer);
  if (next.status === 'running') timer = setTimeout(look, EVERY);
}

async function look() {
  if (!state) return;
  const {id} = state;
  try {
    const next = await get(state.links.self);
    if (state.id === id) adopt(next);
  } catch (error) {
    fill(refused, reason(error).message);
  }
}

/**
 * Open a run of the study: in Live, or with its figures.
 * @param {number} run @param {boolean} live
 */
async function openRun(run, live) {
  if (!state) return;
  fill(refused, h('span', {class: 'soft'}, t('page.studies.opening')));
  try {
    const spec = await get(`${state.links.self}/runs/${run}`);
    if (live) location.assign(`/#s=${await pack({spec, t: 0})}`);
    else {
      const made = await post('/api/runs', spec);
      location.assign(`/runs/?run=${encodeURIComponent(made.id)}`);
    }
  } catch (error) {
    fill(refused, reason(error).message);
  }
}

function drawBar() {
  fill(query('.skip'), t('page.studies.skip'));
  document.title = `${state ? nameOf(state) : t('page.studies.title')} · Thetascope`;
  if (!state)
    return fill(
      bar,
      h(
        'div',
        {class: 'bar-name'},
        h('h1', {}, t('page.studies.title')),
        h('small', {class: 'soft'}, t('page.studies.lead')),
      ),
      h('div', {class: 'study-progress'}, refused),
      h('div', {class: 'study-doing'}, h('a', {class: 'quiet', href: '/runs/'}, t('page.studies.all-runs'))),
    );
  const {links, done, runs, status, problem, mine} = state;
  const table = links['table.csv'].replace(/csv$/, '');
  return fill(
    bar,
    h(
      'div',
      {class: 'bar-name'},
      h('h1', {}, nameOf(state)),
      h('small', {class: 'soft'}, t('page.studies.of', {experiment: state.experiment})),
    ),
    h(
      'div',
      {class: 'study-progress', role: 'status'},
      h(
        'span',
        {class: 'num'},
        h('b', {}, done.toLocaleString('en').replaceAll(',', ' ')),
        ' ',
        t('page.studies.done-of', {runs}),
      ),
      h('progress', {value: done, max: runs, 'aria-label': t('page.studies.progress')}),
      h('span', {class: 'soft num'}, progressWords(state)),
      problem && h('span', {class: 'alarm'}, problem.detail),
      state.refused > 0 && h('span', {class: 'alarm'}, t('page.studies.refused', {n: state.refused})),
      refused,
    ),
    h(
      'div',
      {class: 'study-doing'},
      status === 'running' &&
        mine &&
        h('button', {type: 'button', class: 'quiet', onclick: cancel}, t('page.studies.cancel')),
      (status === 'cancelled' || status === 'failed') &&
        h('button', {type: 'button', class: 'quiet', onclick: goOn}, t('page.studies.go-on')),
      done > 0 &&
        ['csv', 'parquet', 'tex'].map((kind) =>
          h('a', {class: 'quiet', href: table + kind, download: ''}, kind.toUpperCase()),
        ),
      mine &&
        status !== 'running' &&
        h('button', {type: 'button', class: 'quiet', onclick: remove}, t('page.studies.remove')),
      h('a', {class: 'quiet', href: '/studies/'}, t('page.studies.list')),
    ),
  );
}

/** @param {service.StudyState} one */
const nameOf = (one) => one.title || named(experiments.find(({id}) => id === one.experiment)?.title) || one.experiment;

/** @param {service.StudyState} now */
function progressWords(now) {
  const seconds = (Date.now() - begun.at) / 1000;
  const rate = seconds > 1 ? (now.done - begun.done) / seconds : 0;
  if (now.status !== 'running') return t(`page.studies.status.${now.status}`);
  if (rate <= 0) return t('page.studies.status.running');
  return t('page.studies.left', {
    seconds: Math.ceil((now.runs - now.done) / rate),
    rate: Number(rate.toPrecision(2)),
  });
}

async function cancel() {
  if (state) adopt(await post(state.links.cancel));
}

async function goOn() {
  if (!state) return;
  try {
    adopt(await post('/api/studies', await get(state.links.spec)));
  } catch (error) {
    fill(refused, reason(error).message);
  }
}

async function remove() {
  if (!state || !confirm(t('page.studies.remove.sure'))) return;
  await request('DELETE', state.links.self);
  location.href = '/studies/';
}

/** The studies of this client, where none is open. */
function drawList() {
  fill(
    right,
    known.length
      ? h(
          'article',
          {class: 'card study-card study-scroll', tabindex: 0, role: 'region', 'aria-label': t('page.studies.list')},
          h('h2', {}, t('page.studies.list')),
          h(
            'table',
            {},
            h(
              'tbody',
              {},
              known.map((one) =>
                h(
                  'tr',
                  {},
                  h('td', {}, h('a', {href: `?study=${one.id}`}, nameOf(one))),
                  h('td', {class: 'soft'}, one.experiment),
                  h('td', {class: 'num'}, t('page.studies.list.runs', {done: one.done, runs: one.runs})),
                  h('td', {}, t(`page.studies.status.${one.status}`)),
                  h('td', {class: 'soft num'}, one.created.slice(0, 16).replace('T', ' ')),
                ),
              ),
            ),
          ),
        )
      : h(
          'article',
          {class: 'card study-card study-empty'},
          h('h2', {}, t('page.studies.first')),
          h('p', {}, t('page.studies.first.how')),
        ),
  );
}

async function arrive() {
  const id = new URLSearchParams(location.search).get('study');
  const experiment = new URLSearchParams(location.search).get('experiment');
  const run = new URLSearchParams(location.search).get('run');
  clearTimeout(timer);
  state = null;
  if (id) {
    try {
      const found = await get(`/api/studies/${encodeURIComponent(id)}`);
      form.show(await get(found.links.spec));
      return adopt(found);
    } catch (error) {
      fill(refused, reason(error).message);
    }
  }
  ({studies: known} = await get('/api/studies'));
  await form.start(experiment, run);
  drawBar();
  return drawList();
}

addEventListener('popstate', arrive);
mountTop(query('header'), connection, 'runs', () => {
  get('/api/catalogue').then((/** @type {service.Catalogue} */ catalogue) => {
    ({experiments} = catalogue);
    form.translate(experiments);
    drawBar();
    if (!state) drawList();
  });
  drawBar();
  if (state?.done) results.draw();
  else drawList();
});
await arrive();
