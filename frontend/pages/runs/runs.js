// Starts the page: loads the library, opens the choice of the address, and has the actions of the views.

import {connection, follow, get, post, Problem, reason, run} from '../../common/api.js';
import {query} from '../../common/dom.js';
import {read, write} from './address.js';
import {createStore} from './run-state.js';
import {mountChooser} from './chooser.js';
import {mountFigures} from './figures.js';
import {mountHead} from './experiment-head.js';
import {mountSide} from './side-column.js';
import {mountTop} from '../../common/page-header.js';
import {mountVerdicts} from './verdicts.js';
import {chosenLanguage} from '../../i18n/language.js';
import {named, speak, t} from '../../i18n/words.js';

/** @import {Changes, Experiment, Plant, Run, RunActions, RunState} from '../types.js' */
/** @import * as service from '../../types/service.js' */

await speak(chosenLanguage());
const store = createStore();
/** @type {AbortController | null} of the run that is followed */
let following = null;

/** @type {RunActions} */
const act = {
  /** Open an experiment of the library; `run`, an id, shows that run's result where the store still has it. */
  async choose(id, {changes = {}, run: known = null, push = true} = {}) {
    following?.abort();
    if (push) history.pushState(null, '', write({experiment: id}));
    store.dispatch({type: 'choose', id, changes});
    await guarded(async () => {
      /** @type {Experiment} */
      const spec = await get(`/api/experiments/${encodeURIComponent(id)}`);
      const plant = await plantOf(spec);
      if (store.state.chosen !== id) return;
      store.dispatch({type: 'spec', spec, plant});
      if (known) await reopen(known, changes);
    });
  },

  /** Run the chosen experiment with the form's changes. */
  async run() {
    following?.abort();
    const mine = (following = new AbortController());
    const {chosen, changes} = store.state;
    if (chosen === null) return;
    store.dispatch({type: 'start'});
    await guarded(async () => {
      /** @param {RunState['progress']} progress */
      const tell = (progress) => mine.signal.aborted || store.dispatch({type: 'progress', progress});
      const ended = await run({experiment: chosen, set: changes}, tell, mine.signal);
      if (mine.signal.aborted) return;
      if (ended.status === 'failed') throw new Problem(ended.problem ?? {});
      if (ended.status === 'cancelled') store.dispatch({type: 'cancelled'});
      else store.dispatch({type: 'done', run: ended, changes});
    }, mine.signal);
  },

  /** Run an experiment that is not of the library, and show it. */
  async runSpec(make) {
    following?.abort();
    await guarded(async () => {
      /** @type {Run | service.Progress} */
      const started = await post('/api/runs?wait=0', await make());
      location.assign(write({experiment: null, run: started.id}));
    });
  },

  async cancel() {
    const {links} = store.state.progress;
    const {cancel} = links;
    if (cancel) await guarded(() => post(cancel));
  },

  change: (path, to) => store.dispatch({type: 'change', path, to}),
  replace: (changes) => store.dispatch({type: 'changes', changes}),
};

/**
 * Show a run that the address names, once it is done; one that is gone is no error, it can be run again.
 * @param {string} id
 * @param {Changes} changes
 */
async function reopen(id, changes) {
  const {signal} = (following = new AbortController());
  try {
    /** @type {Run | service.Progress} */
    const found = await get(`/api/runs/${encodeURIComponent(id)}`, signal);
    const known = store.state.spec !== null;
    if (known && found.status !== 'done') store.dispatch({type: 'start'});
    const stored = await follow(found, (progress) => known && store.dispatch({type: 'progress', progress}), signal);
    if (stored.status === 'failed') throw new Problem(stored.problem ?? {});
    if (stored.status !== 'done') {
      if (known) store.dispatch({type: 'cancelled'});
      return;
    }
    if (store.state.spec === null)
      store.dispatch({type: 'foreign', spec: stored.spec, plant: await plantOf(stored.spec)});
    store.dispatch({type: 'done', run: stored, changes});
  } catch (error) {
    if (signal.aborted) return;
    if (!(error instanceof Problem && error.status === 404)) throw error;
    if (store.state.spec === null) throw error;
  }
}

/** @param {Experiment} spec @returns {Promise<Plant> | Plant} */
const plantOf = (spec) =>
  typeof spec.plant === 'string' ? get(`/api/plants/${encodeURIComponent(spec.plant)}`) : spec.plant;

/**
 * Carry something out; what goes wrong becomes a problem on the page.
 * @param {() => Promise<unknown>} work
 * @param {AbortSignal} [signal]
 */
async function guarded(work, signal) {
  try {
    await work();
  } catch (error) {
    if (signal?.aborted || reason(error).name === 'AbortError') return;
    const problem =
      error instanceof Problem
        ? error
        : new Problem({
            title: t('page.problem.unreadable'),
            detail: t('page.problem.unreadable.remedy', {error: reason(error).message}),
          });
    store.dispatch({type: 'failed', problem});
  }
}

/** The address follows the choice, the changes and the run, without a new entry in the history. */
store.subscribe((state, before) => {
  if (state.changes === before.changes && state.run === before.run) return;
  const shown = state.run && state.ranWith === JSON.stringify(state.changes) ? state.run.id : null;
  history.replaceState(
    null,
    '',
    write({experiment: state.foreign ? null : state.chosen, changes: state.changes, run: shown}),
  );
});

store.subscribe((state, before) => {
  if (state.spec !== before.spec)
    document.title = state.spec ? `${named(state.spec.title) || state.spec.id} · Thetascope` : 'Thetascope';
});

async function open() {
  const {experiment, changes, run: known} = read(location.search);
  if (experiment) return act.choose(experiment, {changes, run: known, push: false});
  if (known) return guarded(() => reopen(known, {}));
  if (!location.search) return location.reload(); // back to the notebook
  const first = store.state.experiments?.[0];
  return first && act.choose(first.id, {push: false});
}

query('.skip').textContent = t('page.nav.skip-to-figures');
mountTop(query('.top'), connection);
mountChooser(query('.chooser'), store, act);
mountHead(query('.head'), store, act);
mountVerdicts(query('.verdicts'), store);
mountFigures(query('.figures'), store);
mountSide(query('.side'), store);
addEventListener('popstate', open);

await guarded(async () => {
  const [{experiments}, {plants}] = await Promise.all([
    /** @type {Promise<service.ExperimentList>} */ (get('/api/experiments')),
    /** @type {Promise<service.PlantList>} */ (get('/api/plants')),
  ]);
  store.dispatch({type: 'library', experiments, plants: Object.fromEntries(plants.map((plant) => [plant.id, plant]))});
});
await open();
