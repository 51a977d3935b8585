// The plants of the library with their equations, and the check of a plant of one's own.

import {connection, get, post, Problem} from '../../common/api.js';
import {fill, h} from '../../common/dom.js';
import {focusWhenScrolling} from '../../common/scroll-focus.js';
import {mathml} from '../../widgets/equations.js';
import {text} from '../../i18n/pages.js';
import {problemBlock} from '../../common/problem.js';
import {mountTop} from '../../common/page-header.js';

const KINDS = Object.fromEntries((await get('/api/catalogue')).observers.map((kind) => [kind.id, kind.title]));

/** The equations of a plant, as rows. */
function equations(answer) {
  const rows = [...answer.states, ...answer.definitions, ...answer.outputs];
  return focusWhenScrolling(
    h(
      'div',
      {class: 'equations'},
      rows.map((item) =>
        h('div', {class: 'equation'}, mathml(item.math), h('span', {class: 'soft'}, text.named(item.description))),
      ),
    ),
  );
}

function card(line, experiments, editor) {
  const body = h('div', {class: 'body'});
  const fold = h(
    'details',
    {class: 'card plant-card'},
    h('summary', {}, h('b', {}, text.named(line.title) || line.id), h('span', {class: 'soft'}, line.source)),
    body,
  );
  fold.addEventListener('toggle', async () => {
    if (!fold.open || body.childElementCount) return;
    fill(body, h('p', {class: 'soft'}, text.loading));
    const {plant} = await get(`/api/equations/${encodeURIComponent(line.id)}`);
    const open = experiments
      .filter((one) => one.plant === line.id)
      .map((one) =>
        h(
          'a',
          {class: 'quiet', href: `/?experiment=${encodeURIComponent(one.id)}`},
          `${text.goLive}: ${text.named(one.title)}`,
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
      text.copyPlant,
    );
    fill(body, h('p', {}, text.named(line.description)), equations(plant), h('p', {class: 'links'}, open, take));
  });
  return fold;
}

/** What a check found: sizes, equations, which observers can be built and why others cannot. */
async function checked(typed, result) {
  let plant;
  try {
    plant = JSON.parse(typed);
  } catch (error) {
    return fill(result, h('p', {class: 'alarm', role: 'alert'}, `${text.noJson}: ${error.message}`));
  }
  try {
    const [report, {plant: written}] = await Promise.all([
      post('/api/plants/check', plant),
      post('/api/equations', {plant, observers: []}),
    ]);
    return fill(
      result,
      h('p', {role: 'status'}, h('b', {}, text.valid), ` ${text.sizes(report.sizes)}.`),
      equations(written),
      h(
        'ul',
        {class: 'possible'},
        report.observers.map((one) =>
          h(
            'li',
            {},
            h('span', {class: `light ${one.possible ? 'ok' : 'bad'}`}),
            ` ${text.named(KINDS[one.kind]) ?? one.kind} `,
            h('span', {class: 'soft'}, one.possible ? text.canBuild : `${text.cannotBuild}: ${text.said(one.why)}`),
          ),
        ),
      ),
    );
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    return fill(result, problemBlock(error));
  }
}

const root = document.querySelector('.plants');
document.querySelector('.skip').textContent = text.plants;
mountTop(document.querySelector('.top'), connection, 'plants');
const [{plants}, {experiments}] = await Promise.all([get('/api/plants'), get('/api/experiments')]);
const editor = h('textarea', {rows: 14, id: 'own', spellcheck: 'false', placeholder: text.pasteHint});
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
  h('label', {for: 'own'}, h('h2', {}, text.paste)),
  editor,
  h('button', {class: 'run', type: 'submit'}, text.check),
  result,
);
fill(
  root,
  h('h1', {}, text.plants),
  h('p', {class: 'soft'}, text.plantsText),
  plants.map((line) => card(line, experiments, editor)),
  form,
);
