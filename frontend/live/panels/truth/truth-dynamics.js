// Unmodelled dynamics: expressions that are added to the equations of states, and further states.

import {fill, h, symbol} from '../../../common/dom.js';
import {called} from '../../../common/names.js';
import {icon} from '../../../widgets/svg.js';
import {named, t} from '../../../i18n/words.js';
import * as edits from './truth-edits.js';
import {section, textRow} from './truth-rows.js';

/** @import {Context, Section} from './truth-sections.js' */
/** @import {Row} from './truth-rows.js' */
/** @import {Truth} from './truth-edits.js' */
/** @import * as service from '../../../types/service.js' */

/**
 * @param {Context} context
 * @returns {Section}
 */
export function dynamicsSection(context) {
  const {app, plant, change, shown} = context;
  const prime = plant.time.kind === 'discrete' ? '⁺' : '′';
  const added = plant.states.map(({name, description}) =>
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
      Object.keys(truth.dynamics).filter((name) => !truth.states.some((state) => state.name === name)).length,
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
 * The rows of one further state: its name, where it starts, its unit and its equation.
 * @param {Context} context
 * @param {number} place   among the further states
 * @param {string} prime
 */
function stateRows({change, shown}, place, prime) {
  const n = place + 1;
  /** @param {Truth} truth */
  const state = (truth) => truth.states[place] ?? {name: '', initial: 0, unit: ''};
  const name = () => state(shown()).name;
  /** @param {Partial<service.TrueState>} values */
  const set = (values) => change(`states.${place}`, edits.changeState(name(), values));
  const rename = textRow({
    path: `states.${place}.name`,
    label: t('page.truth.state.name'),
    name: t('page.truth.state-of.name', {n}),
    value: (truth) => state(truth).name,
    change(text) {
      const next = text.trim();
      const {states, dynamics} = shown();
      if (next === name()) return undefined;
      if (next === '') return {code: 'page.truth.name-missing', args: {}};
      if (next in dynamics || states.some((one) => one.name === next))
        return {code: 'page.truth.name-taken', args: {name: next}};
      return set({name: next});
    },
  });
  const initial = textRow({
    path: `states.${place}.initial`,
    label: t('page.truth.state.initial'),
    name: t('page.truth.state-of.initial', {n}),
    value: (truth) => String(state(truth).initial),
    change(text) {
      const value = Number(text.trim().replace(',', '.').replace('−', '-'));
      if (text.trim() === '' || !Number.isFinite(value)) return {code: 'page.truth.not-a-number', args: {}};
      return set({initial: value});
    },
  });
  const unit = textRow({
    path: `states.${place}.unit`,
    label: t('page.truth.state.unit'),
    name: t('page.truth.state-of.unit', {n}),
    value: (truth) => state(truth).unit,
    change: (text) => set({unit: text.trim()}),
  });
  const left = h('span', {});
  const equation = textRow({
    path: '',
    label: left,
    name: t('page.truth.state-of.equation', {n}),
    value(truth) {
      fill(left, symbol(state(truth).name), `${prime} =`);
      return truth.dynamics[state(truth).name] ?? '';
    },
    change: (text) => change(`dynamics.${name()}`, edits.setDynamics(name(), text)),
  });
  const remove = h(
    'button',
    {
      type: 'button',
      class: 'plain control-only',
      'aria-label': t('page.truth.remove-state', {n}),
      title: t('page.truth.remove-state', {n}),
      onclick: () => change(`states.${place}`, edits.removeState(name())),
    },
    icon('close', 12),
  );
  const named = {
    ...equation,
    get path() {
      return `dynamics.${name()}`;
    },
  };
  return {
    rows: [rename, initial, unit, named],
    element: h(
      'div',
      {class: 'truth-state', role: 'group', 'aria-label': t('page.truth.state', {n})},
      h('div', {class: 'truth-own'}, rename.element, initial.element, unit.element, remove),
      equation.element,
    ),
  };
}
