// The plants of the library with their equations, and the check of a plant of one's own.

import {connection, get, post, Problem, reason} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {focusWhenScrolling} from '../../common/scroll-focus.js';
import {mathml} from '../../widgets/equations.js';
import {problemBlock} from '../../common/problem.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {named, say, speak, t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */

await speak(chosenLanguage());
/** @type {service.Catalogue} */
const catalogue = await get('/api/catalogue');
const KINDS = Object.fromEntries(catalogue.observers.map((kind) => [kind.id, kind.title]));

/**
 * The equations of a plant, as rows.
 * @param {service.PlantEquations} answer
 */
function equations(answer) {
  const rows = [...answer.states, ...answer.definitions, ...answer.outputs];
  return focusWhenScrolling(
    h(
      'div',
      {class: 'equations'},
      rows.map((item) =>
        h('div', {class: 'equation'}, mathml(item.math), h('span', {class: 'soft'}, named(item.description))),
      ),
    ),
  );
}

/**
 * A plant of the library, with its equations when it is opened.
 * @param {service.PlantLine} line
 * @param {service.ExperimentLine[]} experiments
 * @param {HTMLTextAreaElement} editor
 */
function card(line, experiments, editor) {
  const body = h('div', {class: 'body'});
  const fold = h(
    'details',
    {class: 'card plant-card'},
    h('summary', {}, h('b', {}, named(line.title) || line.id), h('span', {class: 'soft'}, line.source)),
    body,
  );
  fold.addEventListener('toggle', async () => {
    if (!fold.open || body.childElementCount) return;
    fill(body, h('p', {class: 'soft'}, t('page.text.loading')));
    /** @type {service.Equations} */
    const {plant} = await get(`/api/equations/${encodeURIComponent(line.id)}`);
    const open = experiments
      .filter((one) => one.plant === line.id)
      .map((one) =>
        h(
          'a',
          {class: 'quiet', href: `/?experiment=${encodeURIComponent(one.id)}`},
          t('page.plants.open-live', {title: named(one.title)}),
        ),
      );
    const take = h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        onclick: async () => {
          editor.value = JSON.stringify(await get(`/api/plants/${encodeURIComponent(line.id)}`), null, 1);
          editor.scrollIntoView({block: 'center'});
          editor.focus();
        },
      },
      t('page.plants.edit-copy'),
    );
    fill(body, h('p', {}, named(line.description)), equations(plant), h('p', {class: 'links'}, open, take));
  });
  return fold;
}

/**
 * How many states, inputs, outputs and channels a plant has.
 * @param {service.PlantSizes} sizes
 */
const sizes = ({states, inputs, outputs, channels}) =>
  t('page.plants.sizes', {
    sizes: [
      t('page.plants.states', {n: states}),
      t('page.plants.inputs', {n: inputs}),
      t('page.plants.outputs', {n: outputs}),
      t('page.plants.channels', {n: channels}),
    ],
  });

/**
 * The result of a check: sizes, equations, which observers can be built and why others cannot.
 * @param {string} typed
 * @param {HTMLElement} result
 */
async function checked(typed, result) {
  let plant;
  try {
    plant = JSON.parse(typed);
  } catch (error) {
    return fill(
      result,
      h('p', {class: 'alarm', role: 'alert'}, t('page.plants.not-json', {error: reason(error).message})),
    );
  }
  try {
    const [report, {plant: written}] = await Promise.all([
      /** @type {Promise<service.PlantCheck>} */ (post('/api/plants/check', plant)),
      /** @type {Promise<service.Equations>} */ (post('/api/equations', {plant, observers: []})),
    ]);
    return fill(
      result,
      h('p', {role: 'status'}, h('b', {}, t('page.plants.valid')), ` ${sizes(report.sizes)}`),
      equations(written),
      h(
        'ul',
        {class: 'possible'},
        report.observers.map((one) =>
          h(
            'li',
            {},
            h('span', {class: `light ${one.possible ? 'ok' : 'bad'}`}),
            ` ${named(KINDS[one.kind]) ?? one.kind} `,
            h(
              'span',
              {class: 'soft'},
              one.possible ? t('page.plants.can-build') : t('page.plants.cannot-build', {why: say(one.why)}),
            ),
          ),
        ),
      ),
    );
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    return fill(result, problemBlock(error));
  }
}

const root = query('.plants');
query('.skip').textContent = t('page.plants.title');
mountTop(query('.top'), connection, 'plants');
const [{plants}, {experiments}] = await Promise.all([
  /** @type {Promise<service.PlantList>} */ (get('/api/plants')),
  /** @type {Promise<service.ExperimentList>} */ (get('/api/experiments')),
]);
const editor = h('textarea', {rows: 14, id: 'own', spellcheck: 'false', placeholder: t('page.plants.own.hint')});
const result = h('div', {class: 'result'});
const form = h(
  'form',
  {
    class: 'card own',
    onsubmit: (event) => {
      event.preventDefault();
      checked(editor.value, result);
    },
  },
  h('label', {for: 'own'}, h('h2', {}, t('page.plants.own'))),
  editor,
  h('button', {class: 'run', type: 'submit'}, t('page.plants.check')),
  result,
);
fill(
  root,
  h('h1', {}, t('page.plants.title')),
  h('p', {class: 'soft'}, t('page.plants.about')),
  plants.map((line) => card(line, experiments, editor)),
  form,
);
