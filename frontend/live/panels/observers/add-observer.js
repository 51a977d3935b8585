// The form that adds an observer: its kind, label and options. A refusal is shown in place, with its remedy.

import {post} from '../../../common/api.js';
import {fill, h} from '../../../common/dom.js';
import {refusal} from '../../../widgets/controls.js';
import {kindName} from '../../../widgets/kind-name.js';
import {named, say, t} from '../../../i18n/words.js';

/** @import {Plant} from '../../../pages/types.js' */
/** @import {App, ObserverState} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */

/** @typedef {Map<string, () => string | number | null>} Inputs   option → its present value */

/** Labels of observers by kind; an unknown kind is its own label. */
const SHORT = /** @type {{[kind: string]: string}} */ ({
  'zhao-adaptive': 'adaptive',
  'nonsmooth-adaptive': 'nonsmooth',
  'linear-adaptive': 'linear',
  'reduced-order': 'reduced',
  'full-order': 'full',
  'sandwich-nonsmooth': 'nonsmooth',
  'sandwich-conventional': 'conventional',
  'adaptive-kalman': 'kalman',
  'adaptive-kalman-discrete': 'sampled',
  'joint-ekf': 'ekf',
  'joint-ukf': 'ukf',
  'proportional-integral': 'integral',
  'extended-state': 'eso',
  'sliding-mode': 'sliding',
  'unknown-input': 'decoupled',
});

/**
 * Fill `element`, which is shown, with the form; `done` is called when it has been added or given up.
 * @param {HTMLElement} element
 * @param {App} app
 * @param {service.ObserverKind[]} kinds
 * @param {() => void} done
 */
export function createAdder(element, app, kinds, done) {
  const {plant, observers} = app.state;
  const discrete = plant?.time.kind === 'discrete';
  const offered = kinds.filter(
    (kind) => !(kind.time === 'continuous' && discrete) && !(kind.time === 'plant' && !discrete),
  );
  const others = kinds.filter((kind) => !offered.includes(kind));
  /** @param {service.ObserverKind} kind @param {boolean} disabled */
  const option = (kind, disabled) => h('option', {value: kind.id, disabled}, kindName(kind));
  const menu = h(
    'select',
    {'aria-label': t('page.observers.kind')},
    offered.map((kind) => option(kind, false)),
    others.length > 0 && others.map((kind) => option(kind, true)),
  );
  const label = h('input', {
    type: 'text',
    'aria-label': t('page.observers.label'),
    maxlength: 32,
    autocomplete: 'off',
    spellcheck: 'false',
  });
  const about = h('p', {class: 'soft small'});
  const when = h('p', {class: 'soft small'});
  const options = h('div', {class: 'entries'});
  const problem = h('p', {class: 'refused', role: 'alert'});
  const add = h('button', {type: 'submit', class: 'press'}, t('page.observers.add'));
  const cancel = h('button', {type: 'button', class: 'press clear', onclick: done}, t('page.action.cancel'));
  const presses = h('div', {class: 'presses'}, add, cancel);
  const inputs = new Map();
  let typed = false; // a label of one's own outlives another choice of kind
  let used = false; // what somebody has chosen or sent is not changed for him
  label.addEventListener('input', () => {
    typed = true;
  });

  const chosen = () => offered.find((kind) => kind.id === menu.value);
  const choose = () => {
    const kind = chosen();
    about.textContent = named(kind?.summary) ?? '';
    when.textContent = kind ? t('page.observers.when', {when: named(kind.when)}) : '';
    if (!typed) label.value = free(SHORT[kind?.id ?? ''] ?? kind?.id ?? 'observer', observers);
    inputs.clear();
    fill(options, kind && plant ? optionFields(kind, plant, inputs) : null);
    refusal(problem, null);
    presses.scrollIntoView({block: 'nearest'});
  };
  menu.addEventListener('change', () => {
    used = true;
    choose();
  });
  const form = h(
    'form',
    {class: 'add-form', 'aria-label': t('page.observers.add-title')},
    menu,
    about,
    when,
    h('div', {class: 'entries'}, h('label', {}, t('page.observers.label')), label),
    options,
    problem,
    presses,
  );
  form.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape') return;
    event.preventDefault(); // the page's own Escape goes back to now
    done();
  });
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    used = true;
    const given = Object.fromEntries(
      [...inputs].map(([name, read]) => [name, read()]).filter(([, value]) => value !== null),
    );
    add.disabled = true;
    try {
      await app.send({type: 'add-observer', observer: {label: label.value.trim(), kind: menu.value, options: given}});
      done();
    } catch (error) {
      refusal(problem, error);
    } finally {
      add.disabled = false;
    }
  });
  fill(element, form);
  menu.value = offered.find((kind) => kind.estimates_theta)?.id ?? menu.value;
  menu.focus();
  choose();
  if (!plant) return;
  possible(plant).then(
    (found) => {
      if (!mark(menu, found, kinds) || used) return;
      const left = [...menu.options].filter((one) => !one.disabled).map((one) => one.value);
      menu.value = left.find((id) => kinds.find((kind) => kind.id === id)?.estimates_theta) ?? left[0] ?? '';
      choose();
    },
    () => {},
  ); // without it, the refusal says why
}

/** @type {Map<string, Promise<service.PlantCheck['observers']>>} */
const checked = new Map();

/**
 * Which kinds can be built for a plant, and why not: asked once a plant.
 * @param {Plant} plant
 * @returns {Promise<service.PlantCheck['observers']>}
 */
function possible(plant) {
  const key = JSON.stringify(plant);
  const known = checked.get(key);
  if (known) return known;
  /** @type {Promise<service.PlantCheck>} */
  const answer = post('/api/plants/check', plant);
  const observers = answer.then((check) => check.observers);
  checked.set(key, observers);
  return observers;
}

/**
 * Disable the kinds that cannot be built. Returns true if the selected kind is one of them.
 * @param {HTMLSelectElement} menu
 * @param {service.PlantCheck['observers']} found
 * @param {service.ObserverKind[]} kinds
 */
function mark(menu, found, kinds) {
  for (const option of menu.options) {
    const one = found.find(({kind}) => kind === option.value);
    if (!one || one.possible) continue;
    option.disabled = true;
    option.title = say(one.why);
    const kind = kinds.find(({id}) => id === option.value);
    if (kind) option.textContent = t('page.observers.not-here', {title: kindName(kind)});
  }
  return Boolean(menu.selectedOptions[0]?.disabled);
}

/** @param {string} base @param {ObserverState[]} observers */
function free(base, observers) {
  const taken = new Set(observers.map((one) => one.label));
  for (let count = 1; ; count += 1) {
    const name = count === 1 ? base : `${base}-${count}`;
    if (!taken.has(name)) return name;
  }
}

/**
 * The options of a kind; those that every estimating observer has (which channels) come first.
 * @param {service.ObserverKind} kind
 * @param {Plant} plant
 * @param {Inputs} inputs
 */
function optionFields(kind, plant, inputs) {
  const fields = [];
  if (kind.takes_channels && plant.channels.length > 1) fields.push(channelField(plant, inputs, kind.chooses));
  for (const option of kind.options) {
    const input =
      option.kind === 'choice'
        ? h(
            'select',
            {},
            option.choices.map((choice) => h('option', {selected: choice === option.default}, choice)),
          )
        : h('input', {
            type: 'text',
            inputmode: option.kind === 'poles' ? 'text' : 'decimal',
            placeholder: placeholderOf(option),
          });
    input.setAttribute('aria-label', option.name);
    inputs.set(option.name, () =>
      option.kind === 'choice' ? input.value : input.value.trim() === '' ? null : valueOf(option, input.value),
    );
    fields.push(h('label', {title: named(option.meaning)}, option.name.replaceAll('_', ' ')), input);
  }
  return fields;
}

/** @param {service.OptionForm} option */
function placeholderOf(option) {
  if (option.kind === 'poles') return '-4, -3±2j';
  return option.default === null ? t('page.observers.automatic') : String(option.default);
}

/** @param {service.OptionForm} option @param {string} text */
const valueOf = (option, text) => (option.kind === 'poles' ? text.trim() : Number(text));

/**
 * The faults to estimate: all by default, or those that the kind takes by itself.
 * @param {Plant} plant
 * @param {Inputs} inputs
 * @param {boolean} chooses
 */
function channelField(plant, inputs, chooses) {
  const boxes = plant.channels.map(({name, title}) => ({
    box: h('input', {type: 'checkbox', value: name, checked: !chooses}),
    title: ` ${named(title) || name}`,
  }));
  inputs.set('channels', () => {
    const picked = boxes.filter(({box}) => box.checked).map(({box}) => box.value);
    return picked.length === 0 || (!chooses && picked.length === plant.channels.length) ? null : picked.join(',');
  });
  return [
    h('span', {class: 'soft'}, t('page.observers.estimates')),
    h(
      'details',
      {class: 'fold'},
      h('summary', {}, chooses ? t('page.observers.channels-chosen') : t('page.observers.channels')),
      h(
        'div',
        {class: 'boxes'},
        boxes.map(({box, title}) => h('label', {class: 'box'}, box, title)),
      ),
    ),
  ];
}
