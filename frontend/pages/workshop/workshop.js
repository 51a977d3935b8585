// The workshop: a plant as text, checked while it is typed, with what follows from it beside.

import {connection, get} from '../../common/api.js';
import {query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {speak, t} from '../../i18n/words.js';
import {unpack} from '../../live/state/permalink.js';
import {createActions} from './actions.js';
import {mountBar} from './bar.js';
import {mountCards} from './cards/cards.js';
import {followChanges} from './checks.js';
import {keep} from './drafts.js';
import {createEditor} from './editor/editor.js';
import {createPopover} from './fault/popover.js';
import {mountEditorCard} from './editor/editor-card.js';
import {mountList} from './list.js';
import * as shop from './service.js';
import {createStore} from './store.js';

/** @import * as service from '../../types/service.js' */
/** @import {Editor, TextError} from './types.js' */

const FUNCTIONS = (
  'sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt abs sign min max clip heaviside step floor where ' +
  'spow backlash interp'
).split(' ');
const FIELDS = (
  'id title description source time states inputs outputs parameters signals tables definitions algebraic dynamics ' +
  'events channels references controllers name unit initial domain scale default bounds expression value kind enters ' +
  'typical actuator process sensor'
).split(' ');
const KEEP = 500; // ms after the last key

await speak(chosenLanguage());
const store = createStore({
  source: {kind: 'new', id: 'begin', version: null, saved: null, text: ''},
  text: '',
  check: null,
  checking: true, // until the first text is there
  good: null,
  tried: {parameters: {}, initial: {}, inputs: {}},
  trial: null,
  trialProblem: null,
  ranking: null,
  chosen: null,
  mine: [],
  library: [],
  kinds: {},
  problem: null,
  notice: null,
  kept: null,
  cursor: {line: 1, column: 1},
});
/** @type {Editor} */
let editor;
const act = createActions(store, () => editor);

/** @type {ReturnType<typeof setTimeout> | undefined} */
let keeping;
editor = await createEditor('', {
  change(text) {
    if (text === store.state.text) return;
    store.set({text});
    clearTimeout(keeping);
    keeping = setTimeout(() => store.set({kept: keep(store.state.source, store.state.text)}), KEEP);
  },
  cursor: (line, column) => store.set({cursor: {line, column}}),
  save: () => act.save(),
  live: () => (store.state.check?.valid ? act.openLive() : act.toFirstError()),
  fix() {
    const errors = store.state.check?.errors.filter((one) => one.fix) ?? [];
    apply(errors.find((one) => one.place.line >= store.state.cursor.line) ?? errors[0]);
  },
  next() {
    const errors = store.state.check?.errors ?? [];
    const next = errors.find((one) => one.place.line > store.state.cursor.line) ?? errors[0];
    if (next) editor.select(next.place);
  },
});

/** @param {TextError | undefined} error */
function apply(error) {
  if (error?.fix) editor.replace(error.fix, error.fix.text);
}

query('.skip').textContent = t('page.workshop.title');
mountTop(query('.top'), connection, 'workshop');
mountBar(query('.shop-bar'), store, act);
mountList(query('.shop-list'), store, act);
mountEditorCard(query('.editor-card'), editor, store, act);
mountCards(query('.shop-cards'), store, act, editor, createPopover(store, editor));
store.subscribe(
  (state) => state.check,
  ({check}) => {
    editor.showErrors(check?.errors ?? [], apply);
  },
);
store.subscribe(
  (state) => state.good,
  ({good}) => {
    const plant = good?.plant;
    const groups = plant
      ? [plant.states, plant.inputs, plant.outputs, plant.parameters, plant.definitions, plant.signals]
      : [];
    editor.names([...groups.flatMap((group) => group.map((one) => one.name)), ...FUNCTIONS, ...FIELDS]);
  },
);
addEventListener('beforeunload', () => keep(store.state.source, store.state.text));

const [{plants}, {observers}, own] = await Promise.all([
  /** @type {Promise<service.PlantList>} */ (get('/api/plants')),
  /** @type {Promise<service.Catalogue>} */ (get('/api/catalogue')),
  shop.mine(),
]);
store.set({library: plants, mine: own.plants, kinds: Object.fromEntries(observers.map((one) => [one.id, one.title]))});
await open();
followChanges(store);

/** Open the text or plant that the address names; without one, or from a damaged link, the plant saved last. */
async function open() {
  const search = new URLSearchParams(location.search);
  const packed = new URLSearchParams(location.hash.slice(1)).get('p');
  if (packed === null) return openNamed(search);
  const content = /** @type {{text?: unknown}} */ (await unpack(packed).catch(() => ({})));
  if (typeof content.text === 'string') return act.openText(content.text);
  await openNamed(search);
  act.tell(t('page.notice.damaged-link'));
}

/** @param {URLSearchParams} search */
async function openNamed(search) {
  const plant = search.get('plant');
  if (plant) return act.openMine(plant);
  const library = search.get('library');
  if (library) return act.openLibrary(library);
  const last = store.state.mine.find((one) => one.mine);
  return last ? act.openMine(last.id) : act.openTemplate('tank');
}

addEventListener('popstate', open);
