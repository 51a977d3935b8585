// Unmodelled dynamics: expressions that are added to the equations of states, and further states.

import {fill, h, symbol} from '../../../common/dom.js';
import {called} from '../../../common/names.js';
import {named, t} from '../../../i18n/words.js';
import * as edits from './truth-edits.js';
import {stateRows} from './further-state.js';
import {section, textRow} from './truth-rows.js';

/** @import {Context, Section} from './truth-sections.js' */
/** @import {Row} from './truth-rows.js' */
/** @import {Truth} from './truth-edits.js' */

/**
 * @param {Context} context
 * @returns {Section}
 */
export function dynamicsSection(context) {
  const {app, plant, change, shown} = context;
  const prime = plant.time.kind === 'discrete' ? '⁺' : '′';
  const added = addedRows(context, prime);
  /** @type {Row[]} */
  const rows = [...added];
  const list = h('div', {class: 'truth-states'});
  let count = 0;
  const more = h(
    'button',
    {
      type: 'button',
      class: 'link control-only',
      onclick: () => {
        const name = edits.freeName(plant, shown());
        change(`dynamics.${name}`, edits.addState(name));
        rows.find(({path}) => path === `dynamics.${name}`)?.focus();
      },
    },
    t('page.truth.add-state'),
  );
  /**
   * Rows for the further states, made anew where there are more or fewer of them.
   * @param {Truth} truth
   */
  const arrange = (truth) => {
    if (truth.states.length === count) return;
    count = truth.states.length;
    const states = truth.states.map((_, place) => stateRows(context, place, prime));
    rows.splice(added.length, Infinity, ...states.flatMap((one) => one.rows));
    fill(
      list,
      states.map((one) => one.element),
    );
    for (const row of rows) row.disable(app.state.role === 'view');
  };
  const {element, follow} = section(
    t('page.truth.dynamics'),
    [h('p', {class: 'soft'}, t('page.truth.dynamics.hint')), added.map((row) => row.element), list, more],
    (truth) =>
      truth.states.length +
      truth.states.filter(({name}) => (truth.process_noise[name] ?? 0) > 0).length +
      plant.states.filter(({name}) => name in truth.dynamics).length,
  );
  return {
    element,
    rows,
    follow(truth) {
      arrange(truth);
      follow(truth);
      for (const row of rows) row.follow(truth);
    },
  };
}

/**
 * A row for each state of the plant: the expression that is added to its equation.
 * @param {Context} context
 * @param {string} prime
 * @returns {Row[]}
 */
function addedRows({plant, change}, prime) {
  return plant.states.map(({name, description}) =>
    textRow({
      path: `dynamics.${name}`,
      label: [symbol(name), `${prime} +`],
      name: t('page.truth.added-to', {name: called(name, plant)}),
      hint: named(description),
      placeholder: t('page.truth.nothing'),
      value: (truth) => truth.dynamics[name] ?? '',
      change: (text) => change(`dynamics.${name}`, edits.setDynamics(name, text)),
    }),
  );
}
