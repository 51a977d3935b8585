// One further state of the true plant: its name, where it starts, its unit, its equation and its process noise.

import {fill, h, symbol} from '../../../common/dom.js';
import {icon} from '../../../widgets/svg.js';
import {t} from '../../../i18n/words.js';
import * as edits from './truth-edits.js';
import {numberRow, textRow} from './truth-rows.js';
import {noiseScale} from './truth-scales.js';

/** @import {Context} from './truth-sections.js' */
/** @import {Row} from './truth-rows.js' */
/** @import {Truth} from './truth-edits.js' */
/** @import * as service from '../../../types/service.js' */

/** @param {Truth} truth @param {number} place */
const stateAt = (truth, place) => truth.states[place] ?? {name: '', initial: 0, unit: ''};

/**
 * The rows of one further state.
 * @param {Context} context
 * @param {number} place   among the further states
 * @param {string} prime
 */
export function stateRows(context, place, prime) {
  const {change, shown} = context;
  const n = place + 1;
  const name = () => stateAt(shown(), place).name;
  const own = ownRows(context, place);
  const noise = noiseRow(context, place);
  const left = h('span', {});
  const equation = textRow({
    path: '',
    label: left,
    name: t('page.truth.state-of.equation', {n}),
    value(truth) {
      const state = stateAt(truth, place).name;
      fill(left, symbol(state), `${prime} =`);
      return truth.dynamics[state] ?? '';
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
  /**
   * The same row, whose path follows the name of the state.
   * @param {Row} row
   * @param {string} field
   */
  const under = (row, field) => ({
    ...row,
    get path() {
      return `${field}.${name()}`;
    },
  });
  return {
    rows: [...own, under(equation, 'dynamics'), under(noise, 'process_noise')],
    element: h(
      'div',
      {class: 'truth-state', role: 'group', 'aria-label': t('page.truth.state', {n})},
      h(
        'div',
        {class: 'truth-own'},
        own.map((row) => row.element),
        remove,
      ),
      equation.element,
      noise.element,
    ),
  };
}

/**
 * The texts of a state: its name, its initial value and its unit.
 * @param {Context} context
 * @param {number} place
 * @returns {Row[]}
 */
function ownRows({change, shown}, place) {
  const name = () => stateAt(shown(), place).name;
  /**
   * @param {'name' | 'initial' | 'unit'} field
   * @param {(text: string) => Partial<service.TrueState> | {code: string, args: object} | null} read   the changed
   *   value, a refusal, or null where nothing has changed
   */
  const row = (field, read) =>
    textRow({
      path: `states.${place}.${field}`,
      label: t(`page.truth.state.${field}`),
      name: t(`page.truth.state-of.${field}`, {n: place + 1}),
      value: (truth) => String(stateAt(truth, place)[field]),
      change(text) {
        const typed = read(text.trim());
        if (typed === null || 'code' in typed) return typed;
        return change(`states.${place}`, edits.changeState(name(), typed));
      },
    });
  return [
    row('name', (next) => {
      const {states, dynamics} = shown();
      if (next === name()) return null;
      if (next === '') return {code: 'page.truth.name-missing', args: {}};
      const taken = next in dynamics || states.some((one) => one.name === next);
      return taken ? {code: 'page.truth.name-taken', args: {name: next}} : {name: next};
    }),
    row('initial', (typed) => {
      const initial = Number(typed.replace(',', '.').replace('−', '-'));
      return typed === '' || !Number.isFinite(initial) ? {code: 'page.truth.not-a-number', args: {}} : {initial};
    }),
    row('unit', (unit) => ({unit})),
  ];
}

/**
 * @param {Context} context
 * @param {number} place
 */
function noiseRow({spec, change, shown}, place) {
  const name = () => stateAt(shown(), place).name;
  /** @param {number} std */
  const set = (std) => change(`process_noise.${name()}`, edits.setProcessNoise(name(), std));
  /** @param {Truth} truth */
  const value = (truth) => truth.process_noise[stateAt(truth, place).name] ?? 0;
  return numberRow({
    path: '',
    label: t('page.truth.state.noise'),
    name: t('page.truth.state-of.noise', {n: place + 1}),
    hint: t('page.truth.process-noise.hint'),
    unit: '/√s',
    scale: noiseScale(Math.abs(stateAt(shown(), place).initial) || 1, spec.horizon),
    low: 0,
    value,
    differs: (truth) => value(truth) > 0,
    change: set,
    back: () => set(0),
  });
}
