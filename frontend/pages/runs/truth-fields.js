// The form's fields for the truth: how the simulated plant differs from the model.

import {h, symbol} from '../../common/dom.js';
import {perRoot} from '../../widgets/truth-differences.js';
import {named, t} from '../../i18n/words.js';

/** @import {Plant} from '../types.js' */
/** @import {Child} from '../../types/dom.js' */

/**
 * Make the field of a path; `text`: it holds an expression.
 * @typedef {(path: string, label: Child, hint: string, text?: boolean) => HTMLElement} MakeField
 */

const SENSOR = ['correlation', 'period', 'missing', 'jitter'];

/** @param {Child} legend @param {Child[]} children */
const group = (legend, children) => children.length > 0 && h('fieldset', {}, h('legend', {}, legend), children);

/**
 * The fields, folded away; those that are empty are as in the model.
 * @param {Plant} plant
 * @param {MakeField} field
 */
export function truthDetails({parameters, states, outputs, time}, field) {
  /** @param {string} output */
  const sensor = (output) => [
    ...SENSOR.map((name) =>
      field(`truth.outputs.${output}.${name}`, t(`page.truth.sensor.${name}`), t(`page.truth.sensor-hint.${name}`)),
    ),
    field(`truth.outputs.${output}.adds`, [symbol(output), ' +'], t('page.truth.sensor-hint.adds'), true),
  ];
  const prime = time.kind === 'discrete' ? '⁺ +' : '′ +';
  return h(
    'details',
    {class: 'more'},
    h('summary', {}, t('page.runs.reality')),
    h('p', {class: 'soft'}, t('page.runs.reality.hint')),
    h(
      'div',
      {class: 'gains reality-fields'},
      group(t('page.truth.parameters'), [
        field('truth.deviation', t('page.runs.deviation'), t('page.inject.model-hint')),
        ...parameters.map(({name, description, unit}) =>
          field(`truth.parameters.${name}`, symbol(name), [named(description), unit].filter(Boolean).join(', ')),
        ),
      ]),
      group(
        t('page.truth.process-noise'),
        states.map(({name, unit}) => field(`truth.process_noise.${name}`, symbol(name), perRoot(unit))),
      ),
      outputs.map(({name}) => group([t('page.runs.sensor'), ' ', symbol(name)], sensor(name))),
      group(
        t('page.truth.dynamics'),
        states.map(({name}) =>
          field(`truth.dynamics.${name}`, [symbol(name), prime], t('page.truth.dynamics.hint'), true),
        ),
      ),
    ),
  );
}
