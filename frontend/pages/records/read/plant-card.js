// The plant of a record: one of the library, or one of the user's own as a file or text.

import {h, symbol} from '../../../common/dom.js';
import {named, say, t} from '../../../i18n/words.js';
import {itemOf} from './columns.js';

/** @import {RecordActions, RecordState} from '../types.js' */

const OWN = ' own'; // no id of the library
const MINE = ' mine '; // before the id of a plant that was saved
const draft = {text: '', open: false}; // kept while the page is drawn again

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function plantCard(state, act) {
  const {plants, mine, choice, inspection, plant} = state;
  const own = choice !== null && typeof choice === 'object' ? choice : null;
  /** @param {string} value @param {string} words @param {boolean} selected */
  const option = (value, words, selected) => h('option', {value, selected}, words);
  return h(
    'section',
    {class: 'card plant-choice'},
    h('label', {for: 'plant'}, h('h2', {}, t('page.records.plant'))),
    h(
      'select',
      {
        id: 'plant',
        class: choice === null ? 'wanted' : null,
        onchange: ({currentTarget: {value}}) => {
          if (value.startsWith(MINE)) act.chooseMine(value.slice(MINE.length));
          else if (value !== OWN) act.choose(value || null);
        },
      },
      option('', t('page.records.plant.none'), choice === null),
      own && option(OWN, named(own.title) || own.id, true),
      mine.length > 0 &&
        h(
          'optgroup',
          {label: t('page.records.plant.mine')},
          mine.map(({id, title}) => option(`${MINE}${id}`, named(title) || id, false)),
        ),
      plants.map((line) => option(line.id, named(line.title) || line.id, line.id === choice)),
    ),
    plant &&
      inspection &&
      inspection.quantities.length > 0 && [
        h('p', {class: 'soft'}, t('page.records.plant.needs')),
        h(
          'ul',
          {class: 'needs'},
          inspection.quantities.map((one) =>
            h(
              'li',
              {class: one.column === null ? 'lacking' : '', title: named(itemOf(one.name, plant)?.description)},
              symbol(one.name),
              one.column === null ? ' –' : ' ✓',
              h(
                'span',
                {class: 'visually-hidden'},
                one.column === null ? t('page.records.plant.lacking') : t('page.records.plant.there'),
              ),
            ),
          ),
        ),
      ],
    inspection?.plant_text && h('p', {class: 'soft'}, say(inspection.plant_text)),
    ownPlant(act),
  );
}

/** @param {RecordActions} act */
function ownPlant(act) {
  const text = h('textarea', {
    id: 'own-plant',
    rows: 8,
    spellcheck: 'false',
    'aria-label': t('page.records.own.text'),
    placeholder: 'id: my-tank\nstates:\n  - {name: h, unit: cm, initial: 20}\n…',
    oninput: () => {
      draft.text = text.value;
    },
  });
  text.value = draft.text;
  const file = h('input', {
    type: 'file',
    id: 'plant-file',
    accept: '.yaml,.yml,.json',
    'aria-label': t('page.records.own.file'),
    onchange: async () => {
      const [chosen] = file.files ?? [];
      if (chosen) act.usePlantText(await chosen.text());
    },
  });
  return h(
    'details',
    {
      class: 'own-plant',
      open: draft.open,
      ontoggle: ({currentTarget}) => {
        draft.open = currentTarget.open;
      },
    },
    h('summary', {}, t('page.records.own')),
    h('p', {class: 'soft'}, t('page.records.own.hint')),
    file,
    text,
    h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        id: 'use-plant',
        onclick: () => text.value.trim() && act.usePlantText(text.value),
      },
      t('page.records.own.use'),
    ),
  );
}
