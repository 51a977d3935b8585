// The observers on the record: which ones run, and their estimates at the end.

import {h, number, symbol} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {chip, heading} from '../../../widgets/controls.js';
import {kindName} from '../../../widgets/kind-name.js';
import {WIDE} from '../numbers.js';
import {colourOf, repeats} from '../../../widgets/line-style.js';
import {shownObservers} from './observer-strips.js';

/** @import {Columns, Plant, RecordActions, RecordState} from '../types.js' */

const MOST = 6; // observers

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function observersCard(state, act) {
  const {kinds, observers} = state;
  const unused = kinds.filter((one) => !observers.some(({kind}) => kind === one.id));
  const add = h(
    'select',
    {
      id: 'add-observer',
      'aria-label': t('page.records.observers.add'),
      onchange: () => {
        if (add.value) act.observe([...observers, {label: free(observers, add.value), kind: add.value}]);
      },
    },
    h('option', {value: ''}, t('page.records.observers.add')),
    unused.map((one) => h('option', {value: one.id}, kindName(one))),
  );
  return h(
    'section',
    {class: 'card observers-card'},
    heading(t('page.records.observers')),
    h('p', {class: 'soft'}, t('page.records.observers.hint')),
    h(
      'ul',
      {class: 'chosen-observers'},
      observers.map(({label, kind}, place) => {
        const known = kinds.find((one) => one.id === kind);
        return h(
          'li',
          {},
          chip(colourOf(place), repeats(place)),
          h('span', {}, known ? kindName(known) : kind),
          h(
            'button',
            {
              type: 'button',
              class: 'link',
              'aria-label': t('page.records.observers.remove', {label}),
              onclick: () => act.observe(observers.filter((one) => one.label !== label)),
            },
            '×',
          ),
        );
      }),
    ),
    h(
      'div',
      {class: 'buttons'},
      observers.length < MOST && unused.length > 0 && add,
      h(
        'button',
        {
          type: 'button',
          class: 'quiet',
          id: 'run-observers',
          disabled: observers.length === 0 || state.work !== null,
          onclick: () => act.runObservers(),
        },
        t('page.records.observers.run'),
      ),
    ),
    ends(state),
  );
}

/**
 * A label that no observer has yet.
 * @param {RecordState['observers']} observers
 * @param {string} kind
 */
const free = (observers, kind) =>
  [kind, ...observers.map((_, k) => `${kind}-${k + 2}`)].find((one) => !observers.some(({label}) => label === one)) ??
  kind;

/** θ̂ of each observer at the end, with its band. @param {RecordState} state */
function ends({runs, plant}) {
  const shown = shownObservers(runs);
  if (!plant || shown.length === 0) return null;
  return h(
    'div',
    {class: 'wide', tabindex: 0, role: 'region', 'aria-label': t('page.records.observers.end')},
    h(
      'table',
      {class: 'ends'},
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          h('th', {scope: 'col'}, t('page.records.observers.end')),
          shown.map(({colour, title}) => h('th', {scope: 'col', title}, chip(colour), h('small', {}, title))),
        ),
      ),
      h(
        'tbody',
        {},
        plant.channels.map(({name, unit}) =>
          h(
            'tr',
            {},
            h('th', {scope: 'row'}, symbol(name), unit && h('small', {}, ` ${unit}`)),
            shown.map(({columns, label}) => h('td', {}, ending(columns, label, name))),
          ),
        ),
      ),
    ),
  );
}

/** @param {Columns} columns @param {string} label @param {string} name */
function ending(columns, label, name) {
  const value = columns[`${label}.theta.${name}`]?.at(-1) ?? null;
  const sigma = columns[`${label}.sigma.${name}`]?.at(-1) ?? null;
  if (value === null) return '–';
  return sigma === null ? number(value, 3) : `${number(value, 3)} ± ${number(WIDE * sigma, 2)}`;
}
