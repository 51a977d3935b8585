// What the buttons do: open, save, delete, take the plant to other pages.

import {pack} from '../../live/state/permalink.js';
import {named, t} from '../../i18n/words.js';
import {asProblem} from './checks.js';
import {keep, kept} from './drafts.js';
import * as service from './service.js';
import {chosenKinds, errorsOf, idIn, isChanged} from './store.js';
import {TEMPLATES} from './templates.js';

/** @import {Editor, ShopActions, ShopState, ShopStore, Source} from './types.js' */

const NOTICE = 10_000; // ms

/**
 * @param {ShopStore} store
 * @param {() => Editor} editor
 * @returns {ShopActions}
 */
export function createActions(store, editor) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @param {string} text @param {(() => void) | null} [undo] */
  function notice(text, undo = null) {
    clearTimeout(timer);
    store.set({notice: {text, undo}});
    timer = setTimeout(() => store.set({notice: null}), NOTICE);
  }

  /** @param {() => Promise<unknown>} work */
  async function guarded(work) {
    try {
      store.set({problem: null});
      await work();
    } catch (error) {
      store.set({problem: asProblem(error)});
    }
  }

  /**
   * Show a plant; a text that was typed before and not saved comes back.
   * @param {Source} source
   * @param {string} text
   */
  function show(source, text) {
    const earlier = kept(source);
    const next = earlier ?? text;
    store.set({
      source,
      text: next,
      check: null,
      good: null,
      trial: null,
      trialProblem: null,
      ranking: null,
      chosen: null,
      tried: {parameters: {}, initial: {}, inputs: {}},
      kept: earlier === null ? null : Date.now(),
      problem: null,
    });
    editor().setText(next);
    if (earlier !== null && earlier !== text)
      notice(t('page.workshop.kept.back'), () => {
        keep(source, source.text);
        show(source, source.text);
        store.set({notice: null});
      });
    address();
  }

  function address() {
    const {source} = store.state;
    const query = source.kind === 'new' ? '' : `?${source.kind === 'mine' ? 'plant' : 'library'}=${source.id}`;
    history.replaceState(null, '', `/workshop/${query}`);
  }

  async function refreshMine() {
    store.set({mine: (await service.mine()).plants});
  }

  async function save() {
    const {text, source} = store.state;
    let id = idIn(text) || (source.kind === 'mine' ? source.id : 'my-plant');
    let content = text;
    if (store.state.library.some((line) => line.id === id)) {
      // a copy of the library gets an id of its own
      const own = `my-${id}`.slice(0, 64);
      content = text.replace(new RegExp(`(["']?id["']?\\s*:\\s*["']?)${id}\\b`), `$1${own}`);
      id = own;
    }
    let done = false;
    await guarded(async () => {
      const saved = await service.save(id, content);
      if (content !== text) editor().setText(content, true);
      keep(source, source.text);
      store.set({
        ...(content === text ? {} : {text: content}), // what was typed in the meantime stays
        source: {kind: 'mine', id: saved.id, version: saved.version, saved: saved.saved, text: content},
        kept: null,
      });
      notice(t(saved.ready ? 'page.workshop.saved' : 'page.workshop.saved.draft', {n: saved.version}));
      address();
      await refreshMine();
      done = true;
    });
    return done;
  }

  /** The experiment that is opened live or run: observers that are ticked, values of the sliders. */
  async function experiment() {
    const {trial, tried, state} = {...store.state, state: store.state};
    if (!trial) throw new Error(t('page.workshop.simulating'));
    const observers = chosenKinds(state).map((kind) => ({label: kind, kind}));
    const inputs = {...trial.experiment.inputs, ...tried.inputs}; // the trial may be older than the last choice
    return {...trial.experiment, parameters: tried.parameters, initial: tried.initial, inputs, observers};
  }

  /** @type {ShopActions} */
  const act = {
    tell: notice,
    openMine: (id, version) =>
      guarded(async () => {
        const plant = await service.open(id, version);
        /** @type {Source} */
        const source = {kind: 'mine', id, version: plant.version, saved: plant.saved, text: plant.text};
        if (version) keep(source, source.text); // the version is wanted, not changes of another one
        show(source, plant.text);
      }),
    openLibrary: (id) =>
      guarded(async () => {
        const {text} = await service.libraryText(id);
        show({kind: 'library', id, version: null, saved: null, text}, text);
      }),
    openTemplate(name) {
      const text = TEMPLATES[name]();
      show({kind: 'new', id: name, version: null, saved: null, text: ''}, text);
    },
    openText(text) {
      const id = idIn(text) || 'file';
      const source = /** @type {const} */ ({kind: 'new', id: `file-${id}`, version: null, saved: null, text: ''});
      keep(source, '');
      show(source, text);
    },
    save,
    remove: (id) =>
      guarded(async () => {
        const line = store.state.mine.find((one) => one.id === id);
        await service.remove(id);
        await refreshMine();
        if (store.state.source.kind === 'mine' && store.state.source.id === id)
          store.set({source: {kind: 'new', id, version: null, saved: null, text: ''}});
        notice(t('page.workshop.deleted', {title: named(line?.title) || id}), () =>
          guarded(async () => {
            const back = await service.restore(id);
            await refreshMine();
            store.set({notice: null});
            if (store.state.source.kind === 'new' && store.state.source.id === id)
              store.set({source: {kind: 'mine', id, version: back.version, saved: back.saved, text: back.text}});
          }),
        );
      }),
    openLive: () =>
      guarded(async () => {
        location.assign(`/#s=${await pack({spec: await experiment(), t: 0, play: true})}`);
      }),
    run: () =>
      guarded(async () => {
        const {id} = await service.run(await withFault(await experiment(), store.state));
        location.assign(`/runs/?run=${id}`);
      }),
    findFaults: () =>
      guarded(async () => {
        if ((isChanged(store.state) || store.state.source.kind === 'new') && !(await save())) return;
        const {source} = store.state;
        location.assign(`/records/?plant=${encodeURIComponent(source.id)}`);
      }),
    async link() {
      const {source, text} = store.state;
      const link = `/workshop/#p=${await pack({text, id: source.id})}`;
      history.replaceState(null, '', link);
      return `${location.origin}${link}`;
    },
    download() {
      const {text} = store.state;
      const format = text.trimStart().startsWith('{') ? 'json' : 'yaml';
      const anchor = document.createElement('a');
      anchor.href = URL.createObjectURL(new Blob([text], {type: `application/${format}`}));
      anchor.download = `${idIn(text) || 'plant'}.${format}`;
      anchor.click();
      setTimeout(() => URL.revokeObjectURL(anchor.href), 1000);
    },
    convert: (format) =>
      guarded(async () => {
        const {text} = await service.edit(store.state.text, {format});
        editor().setText(text, true);
      }),
    toFirstError() {
      const [first] = errorsOf(store.state);
      if (first) editor().select(first.place);
    },
    edit: (changes) =>
      guarded(async () => {
        const {text, lines} = await service.edit(store.state.text, changes);
        editor().setText(text, true);
        editor().mark(lines);
        store.set({tried: {...store.state.tried, parameters: {}, initial: {}}});
      }),
  };
  return act;
}

/**
 * An experiment with the first fault from the middle on: a run without a fault shows little.
 * @param {{[field: string]: unknown}} spec
 * @param {ShopState} state
 */
async function withFault(spec, {trial}) {
  const [channel, size] = Object.entries(trial?.preview.sizes ?? {})[0] ?? [];
  if (!channel || !trial) return spec;
  return {...spec, faults: [{channel, shape: 'step', onset: trial.preview.onset, size}]};
}
