// Parameters that are fitted on the healthy stretch: before, after, and which of them; and the fitted plant as a file.

import {h, number, symbol} from '../../../common/dom.js';
import {named, t} from '../../../i18n/words.js';
import {withInterval} from '../numbers.js';

/** @import * as service from '../../../types/service.js' */
/** @import {RecordActions, RecordState} from '../types.js' */

const Z95 = 1.96;

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function parametersCard({plant, diagnosis, settings}, act) {
  if (!plant || plant.parameters.length === 0) return null;
  const fitted = new Map(diagnosis?.fit.parameters.map((one) => [one.name, one]));
  const chosen = new Set(settings.fit === 'auto' ? fitted.keys() : settings.parameters);
  /** @param {string} name @param {boolean} on */
  const choose = (name, on) => {
    const names = new Set(chosen);
    if (on) names.add(name);
    else names.delete(name);
    act.set({fit: names.size ? 'chosen' : 'never', parameters: [...names]});
  };
  return h(
    'section',
    {class: 'card fit-card'},
    h(
      'div',
      {class: 'heading'},
      h('h2', {}, t('page.records.fit-it')),
      modeChoice(settings, chosen.size ? [...chosen] : plant.parameters.map(({name}) => name), act),
    ),
    h(
      'table',
      {class: 'parameters'},
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          h('th', {scope: 'col'}, t('page.records.fit-it.parameter')),
          h('th', {scope: 'col'}, t('page.records.fit-it.before')),
          h('th', {scope: 'col'}, t('page.records.fit-it.after')),
        ),
      ),
      h(
        'tbody',
        {},
        plant.parameters.map((one) => row(one, fitted.get(one.name), chosen.has(one.name), choose)),
      ),
    ),
    [...fitted.values()].some((one) => one.held) && h('p', {class: 'held-note'}, t('page.records.fit-it.held-note')),
    fitted.size > 0 && [
      h('p', {class: 'soft'}, t('page.records.fit-it.own-plant')),
      h(
        'div',
        {class: 'buttons'},
        h(
          'button',
          {type: 'button', class: 'quiet', onclick: () => act.downloadPlant('yaml')},
          t('page.records.fit-it.download-yaml'),
        ),
        h('button', {type: 'button', class: 'quiet', onclick: () => act.downloadPlant('json')}, 'JSON'),
      ),
    ],
  );
}

/** @param {service.RecordSettings} settings @param {string[]} ticked @param {RecordActions} act */
function modeChoice({fit}, ticked, act) {
  const modes = /** @type {const} */ (['auto', 'never', 'chosen']);
  return h(
    'select',
    {
      id: 'fit-mode',
      'aria-label': t('page.records.fit-it.mode'),
      onchange: ({currentTarget: {value}}) =>
        act.set({fit: modes.find((one) => one === value) ?? 'auto', parameters: value === 'chosen' ? ticked : []}),
    },
    modes.map((mode) => h('option', {value: mode, selected: mode === fit}, t(`page.records.fit-mode.${mode}`))),
  );
}

/**
 * @param {service.Plant['parameters'][number]} parameter
 * @param {service.FittedParameterReport | undefined} fitted
 * @param {boolean} chosen
 * @param {(name: string, on: boolean) => void} choose
 */
function row({name, value, unit, description}, fitted, chosen, choose) {
  const box = h('input', {
    type: 'checkbox',
    id: `fit-${name}`,
    checked: chosen,
    onchange: ({currentTarget}) => choose(name, currentTarget.checked),
  });
  return h(
    'tr',
    {},
    h('td', {}, h('label', {title: named(description)}, box, symbol(name), h('small', {}, unit))),
    h('td', {class: 'num'}, number(fitted?.before ?? value)),
    h('td', {class: 'num'}, after(fitted)),
  );
}

/** @param {service.FittedParameterReport | undefined} fitted */
function after(fitted) {
  if (!fitted) return '–';
  if (fitted.held) return h('span', {class: 'soft'}, t('page.records.fit-it.held'));
  const {value, std} = fitted;
  if (std === null) return h('b', {}, number(value));
  return h('b', {}, withInterval({value, low: value - Z95 * std, high: value + Z95 * std}));
}
