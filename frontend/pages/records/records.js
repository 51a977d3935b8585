// The page of records: a file is read, the model is checked against it, and its faults are found.

import {connection, get, Problem, reason} from '../../common/api.js';
import {fill, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {pack} from '../../live/state/permalink.js';
import {chosenLanguage} from '../../i18n/language.js';
import {speak, t} from '../../i18n/words.js';
import * as address from './address.js';
import {bar} from './bar.js';
import {findingsCsv} from './findings/findings-csv.js';
import {findingsStep} from './findings/findings-step.js';
import {fitStep} from './fit/fit-step.js';
import {yamlOf} from './fit/plant-yaml.js';
import {refill} from './read/columns.js';
import {takeFiles} from './read/drop.js';
import {lightTogether} from './read/findings-list.js';
import {readStep} from './read/read-step.js';
import * as service from './service.js';

/** @import * as wire from '../../types/service.js' */
/** @import {Mapping, PlantChoice, RecordActions, RecordState, Settings, Work} from './types.js' */

await speak(chosenLanguage());

/** @type {Settings} */
const DEFAULTS = {healthy: null, false_alarms: 0.01, fit: 'auto', parameters: []};
const MOST_EARLIER = 8; // records in the list

/** @type {RecordState} */
let state = {
  plants: [],
  choice: null,
  plant: null,
  inspection: null,
  mapping: null,
  preview: null,
  settings: DEFAULTS,
  diagnosis: null,
  kinds: [],
  observers: [{label: 'joint-ekf', kind: 'joint-ekf'}],
  runs: [],
  mine: [],
  stale: false,
  step: 1,
  work: null,
  problem: null,
  refused: null,
  earlier: [],
  remark: null,
};
/** @type {AbortController | null} of the work that can be cancelled */
let running = null;
const [top, work] = [query('.record-bar'), query('.work')];

/** @param {Partial<RecordState>} changes */
function update(changes) {
  state = {...state, ...changes};
  render();
}

function render() {
  const inBar = top.contains(document.activeElement);
  refill(top, bar(state, act, {copyLink, exportFindings}));
  if (inBar && !top.contains(document.activeElement)) focusOn('#cancel', '#next');
  const steps = {1: readStep, 2: fitStep, 3: findingsStep};
  work.className = `work step-${state.step}`;
  top.toggleAttribute('data-working', state.work !== null);
  refill(work, steps[state.step](state, act));
}

/**
 * Focus the first of these that the page has.
 * @param {...string} selectors
 */
function focusOn(...selectors) {
  const found = selectors.map((one) => document.querySelector(one)).find((one) => one !== null);
  if (found instanceof HTMLElement) found.focus({preventScroll: true});
}

/**
 * Do something that takes a while, can be cancelled, and may be refused.
 * @param {Work} name
 * @param {(signal: AbortSignal) => Promise<void>} task
 */
async function during(name, task) {
  running?.abort();
  const mine = (running = new AbortController());
  update({work: name, problem: null});
  const began = performance.now();
  const clock = setInterval(() => showElapsed(performance.now() - began), 1000);
  try {
    await task(mine.signal);
  } catch (error) {
    if (!mine.signal.aborted) update({problem: asProblem(error), refused: name});
  } finally {
    clearInterval(clock);
    if (running === mine) {
      running = null;
      update({work: null});
      await keepAddress();
    }
  }
}

/** @param {number} time  ms */
function showElapsed(time) {
  const element = top.querySelector('.elapsed');
  if (element) element.textContent = `${Math.round(time / 1000)}\u202fs`;
}

/** @param {unknown} error */
function asProblem(error) {
  if (error instanceof Problem) return error;
  return new Problem({
    title: t('page.problem.unreadable'),
    detail: t('page.problem.unreadable.remedy', {error: reason(error).message}),
  });
}

/** The address reopens the record. */
async function keepAddress() {
  const {inspection, choice, mapping, settings, step} = state;
  const changed = JSON.stringify(settings) !== JSON.stringify(DEFAULTS);
  const link = {record: inspection?.id || null, plant: choice, mapping, settings: changed ? settings : null, step};
  history.replaceState(null, '', `${location.pathname}${await address.write(link)}`);
}

/** The body of requests about the present record. */
function present() {
  const {inspection, choice, mapping} = state;
  if (!inspection || choice === null) throw new Problem({title: t('page.records.choose-plant')});
  return {id: inspection.id, body: {plant: choice, mapping: mapping ?? undefined}};
}

/**
 * Inspect the stored record with plant and mapping, and fetch its curves.
 * @param {string} id
 * @param {Mapping | null} mapping   null: the guess
 * @param {AbortSignal} signal
 */
async function inspect(id, mapping, signal) {
  if (state.choice === null) {
    update({preview: state.inspection?.times ? await service.preview(id, signal) : null});
    return;
  }
  const body = {plant: state.choice, mapping: mapping ?? undefined};
  const inspection = await service.inspect(id, body, signal);
  const drawable = inspection.times !== null && inspection.quantities.some((one) => one.column !== null);
  const preview = drawable ? await service.preview(id, signal) : null;
  update({inspection, mapping, preview, stale: state.diagnosis !== null});
}

/** @param {PlantChoice | null} choice @param {AbortSignal} signal */
async function choosePlant(choice, signal) {
  /** @type {RecordState['plant']} */
  const plant = typeof choice === 'string' ? await get(`/api/plants/${encodeURIComponent(choice)}`, signal) : choice;
  update({choice, plant, mapping: null, preview: null, diagnosis: null, runs: [], stale: false, step: 1});
  if (state.inspection) await inspect(state.inspection.id, null, signal);
}

/** @param {File} file @param {AbortSignal} signal */
async function read(file, signal) {
  update({
    inspection: null,
    mapping: null,
    preview: null,
    diagnosis: null,
    runs: [],
    stale: false,
    step: 1,
    remark: null,
  });
  update({settings: {...DEFAULTS, false_alarms: state.settings.false_alarms}});
  const inspection = await service.upload(file, signal);
  update({inspection});
  await inspect(inspection.id, null, signal);
}

/** @type {RecordActions} */
const act = {
  open: (file) => during('reading', (signal) => read(file, signal)),
  simulate: () =>
    during('simulating', async (signal) => {
      const chosen = typeof state.choice === 'string' ? state.choice : null;
      const {file, experiment, plant} = await service.simulated(chosen, signal);
      if (plant !== state.choice) await choosePlant(plant, signal);
      await read(file, signal);
      update({remark: () => t('page.records.simulated', {id: experiment})});
    }),
  choose: (choice) => during('mapping', (signal) => choosePlant(choice, signal)),
  usePlantText: (text) =>
    during('mapping', async (signal) => choosePlant(await service.readPlant(text, signal), signal)),
  map: (mapping) => during('mapping', (signal) => inspect(present().id, mapping, signal)),
  set(changes) {
    update({settings: {...state.settings, ...changes}, stale: state.diagnosis !== null});
    keepAddress();
  },
  diagnose: ({mapping, parameters} = {}) =>
    during('diagnosing', async (signal) => {
      const {id} = present();
      if (mapping) await inspect(id, mapping, signal);
      const settings = parameters
        ? {...state.settings, fit: /** @type {const} */ ('chosen'), parameters}
        : state.settings;
      const {step} = state;
      update({settings, step: step === 3 ? 3 : 2});
      const diagnosis = await service.diagnose(id, {...present().body, settings}, signal);
      const fits = diagnosis.fit.verdict !== 'does-not-fit';
      update({diagnosis, runs: [], stale: false, step: step === 3 && fits ? 3 : 2});
    }),
  downloadPlant: (format) =>
    during('fitting', async (signal) => {
      const {id, body} = present();
      const parameters = state.diagnosis?.fit.parameters.map((one) => one.name) ?? [];
      const settings = {...state.settings, fit: /** @type {const} */ ('chosen'), parameters};
      const {plant} = await service.fit(id, {...body, settings}, signal);
      const text = format === 'yaml' ? yamlOf(plant) : `${JSON.stringify(plant, null, 1)}\n`;
      save(text, `${plant.id}-fitted.${format}`, format === 'yaml' ? 'application/yaml' : 'application/json');
    }),
  chooseMine: (id) => during('mapping', async (signal) => choosePlant(await service.saved(id, signal), signal)),
  observe: (observers) => update({observers}),
  runObservers: () =>
    during('observing', async (signal) => {
      const {id, body} = present();
      const earlier = state.runs.length ? [] : await service.storedRuns(id, state.inspection?.name ?? '', signal);
      const run = await service.observe(id, {...body, settings: state.settings, observers: state.observers}, signal);
      const others = [...state.runs, ...earlier].filter((one) => one.id !== run.id);
      update({runs: [run, ...others.map((one) => ({...one, shown: false}))]});
    }),
  compare: (id, shown) => update({runs: state.runs.map((one) => (one.id === id ? {...one, shown} : one))}),
  async replay() {
    const [run] = state.runs;
    if (run) location.href = `/#s=${await pack({spec: run.spec, t: 0})}`;
  },
  go(step) {
    update({step, problem: null});
    scrollTo(0, 0);
    keepAddress();
  },
  cancel() {
    running?.abort();
    running = null;
    update({work: null, step: state.diagnosis ? state.step : 1});
  },
  startOver() {
    running?.abort();
    update({
      inspection: null,
      mapping: null,
      preview: null,
      diagnosis: null,
      runs: [],
      step: 1,
      problem: null,
      remark: null,
    });
    keepAddress();
    focusOn('#choose-file');
  },
};

/** @param {string} text @param {string} name @param {string} type */
function save(text, name, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], {type}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** @param {'json' | 'csv'} format */
function exportFindings(format) {
  const {diagnosis, inspection} = state;
  if (!diagnosis || !inspection) return;
  const base = `${inspection.name.replace(/\.[^.]*$/u, '')}-findings`;
  if (format === 'csv') save(findingsCsv(diagnosis.faults), `${base}.csv`, 'text/csv');
  else save(`${JSON.stringify(diagnosis, null, 1)}\n`, `${base}.json`, 'application/json');
}

async function copyLink() {
  await keepAddress();
  const button = top.querySelector('#copy-link');
  try {
    await navigator.clipboard.writeText(location.href);
    if (button) fill(button, t('page.records.link.copied'));
  } catch {
    if (button) fill(button, t('page.records.link.in-address'));
  }
}

/**
 * Choose the plant of one's own that a stored record had last, with its mapping.
 * @param {wire.RecordInspection} inspection
 * @param {AbortSignal} signal
 */
async function chooseAgain({id, mapping}, signal) {
  const plant = await service.plantOf(id, signal);
  update({choice: plant, plant});
  await inspect(id, mapping, signal);
}

/** Open what the address names. */
async function openAddress() {
  const link = await address.read(location);
  if (link.plant === null && link.record === null) return;
  await during('reading', async (signal) => {
    if (link.settings) update({settings: {...DEFAULTS, ...link.settings}});
    if (link.plant !== null) await choosePlant(link.plant, signal);
    if (link.record === null) return;
    const inspection = await service.stored(link.record, signal);
    update({inspection});
    const known = state.plants.some(({id}) => id === inspection.plant);
    const own = link.plant === null && inspection.plant && !known;
    if (link.plant === null && known) await choosePlant(inspection.plant, signal);
    else if (own) await chooseAgain(inspection, signal);
    else await inspect(link.record, link.mapping, signal);
    if (link.step === 1 || !state.inspection?.ready) return;
    update({work: 'diagnosing', step: 2});
    const diagnosis = await service.diagnose(link.record, {...present().body, settings: state.settings}, signal);
    update({diagnosis, step: link.step === 3 && diagnosis.fit.verdict !== 'does-not-fit' ? 3 : 2});
  });
}

/** The plants, in the page's language. */
async function loadPlants() {
  const [{plants}, {records}, {observers: kinds}, {plants: mine}] = await Promise.all([
    /** @type {Promise<wire.PlantList>} */ (get('/api/plants')),
    /** @type {Promise<wire.RecordList>} */ (get(`/api/records?limit=${MOST_EARLIER}`)),
    /** @type {Promise<wire.Catalogue>} */ (get('/api/catalogue')),
    /** @type {Promise<wire.MyPlantList>} */ (get('/api/my-plants')),
  ]);
  const {choice} = state;
  const plant = typeof choice === 'string' ? await get(`/api/plants/${encodeURIComponent(choice)}`) : state.plant;
  query('.skip').textContent = t('page.records.title');
  top.setAttribute('aria-label', t('page.records.record'));
  update({plants, plant, earlier: records, kinds, mine});
}

mountTop(query('.top'), connection, 'records', loadPlants);
lightTogether(work);
takeFiles(act);
await loadPlants();
await openAddress();
