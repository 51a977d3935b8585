// The form for changes before a run: seed, noise, gains, and any other value by its path.
// Values go to the server as they are typed; a refusal is shown under the field that it names.

import {asTyped, value} from './address.js';
import {fill, h, symbol} from '../../common/dom.js';
import {original, formField} from './run-state.js';
import {explained} from '../../common/problem.js';
import {chip} from '../../widgets/controls.js';
import {colourOf, repeats} from '../../widgets/line-style.js';
import {truthDetails} from './truth-fields.js';
import {t} from '../../i18n/words.js';

/** @import {RunActions, RunState, RunStore} from '../types.js' */
/** @import {Child} from '../../types/dom.js' */

const EXAMPLE = 'faults.theta3.size = 0.03\nhorizon = 50';

/** @param {RunStore} store @param {RunActions} act */
export function createForm(store, act) {
  /** @type {Map<string, {input: HTMLInputElement, error: HTMLElement}>} by path */
  const fields = new Map();
  const element = h('form', {
    id: 'form',
    novalidate: true,
    autocomplete: 'off',
    onsubmit: (event) => {
      event.preventDefault();
      if (!store.state.foreign && store.state.spec && store.state.phase !== 'running') act.run();
    },
  });
  const more = h('textarea', {
    rows: 3,
    spellcheck: 'false',
    placeholder: EXAMPLE,
    id: 'more',
    'aria-describedby': 'more-error',
    oninput: readMore,
  });
  const moreError = h('p', {class: 'error', id: 'more-error'});
  const reset = h(
    'button',
    {
      type: 'button',
      class: 'quiet',
      hidden: true,
      onclick: () => {
        act.replace({});
        build();
      },
    },
    t('page.runs.reset'),
  );
  /** @type {HTMLDetailsElement | null} */
  let details = null;
  /** @type {HTMLDetailsElement | null} */
  let reality = null;

  /**
   * @param {string} path
   * @param {Child} label
   * @param {string} hint
   * @param {boolean} [text]   whether it holds an expression
   */
  function field(path, label, hint, text = false) {
    const {spec, changes} = store.state;
    const id = `field-${path.replaceAll('.', '-')}`;
    const error = h('p', {class: 'error', id: `${id}-error`});
    /** @type {HTMLInputElement} */
    const input = h('input', {
      id,
      type: 'text',
      inputmode: text ? 'text' : 'decimal',
      title: hint,
      'aria-describedby': error.id,
      value: asTyped(changes[path] ?? original(spec, path)) ?? '',
      oninput() {
        const typed = input.value.trim();
        act.change(path, typed === '' ? undefined : text ? typed : value(typed));
      },
    });
    fields.set(path, {input, error});
    return h('div', {class: 'field'}, h('label', {for: id}, label), input, error);
  }

  /** The fields of the truth, unfolded where the changes set one. */
  function truthFields() {
    const {plant, changes} = store.state;
    if (!plant) return null;
    const open = reality?.open ?? false;
    reality = truthDetails(plant, field);
    reality.open = open || Object.keys(changes).some((path) => path.startsWith('truth.') && fields.has(path));
    return reality;
  }

  function build() {
    const {spec, changes} = store.state;
    if (!spec) return;
    fields.clear();
    const noise = Object.keys(spec.noise).map((output) =>
      field(`noise.${output}.std`, [t('page.runs.noise-of'), ' ', symbol(output)], t('page.runs.noise.hint')),
    );
    const gains = spec.observers
      .map((observer, place) => ({observer, place, names: Object.keys(observer.gains)}))
      .filter(({names}) => names.length)
      .map(({observer, place, names}) =>
        h(
          'fieldset',
          {},
          h('legend', {}, chip(colourOf(place), repeats(place)), observer.label),
          names.map((name) =>
            field(
              `observers.${observer.label}.gains.${name}`,
              symbol(name),
              t('page.observers.gains-of', {label: observer.label}),
            ),
          ),
        ),
      );
    const open = details?.open ?? false;
    details = h(
      'details',
      {class: 'more'},
      h('summary', {}, t('page.runs.gains')),
      h('div', {class: 'gains'}, gains),
      h('label', {for: 'more'}, t('page.runs.more')),
      more,
      moreError,
    );
    const truth = truthFields();
    details.open = open || Object.keys(changes).some((path) => path !== 'seed' && !/^(noise|truth)\./.test(path));
    more.value = Object.entries(changes)
      .filter(([path]) => !fields.has(path))
      .map(([path, to]) => `${path} = ${asTyped(to)}`)
      .join('\n');
    fill(moreError);
    fill(
      element,
      h(
        'div',
        {class: 'row'},
        field('seed', t('page.runs.seed'), t('page.runs.seed.hint')),
        noise.length ? noise : h('p', {class: 'soft'}, t('page.runs.no-noise')),
        reset,
      ),
      truth,
      details,
    );
    update(store.state, null);
  }

  function readMore() {
    const changes = Object.fromEntries(Object.entries(store.state.changes).filter(([path]) => fields.has(path)));
    fill(moreError);
    for (const line of more.value.split('\n').filter((one) => one.trim())) {
      const [path, ...rest] = line.split('=');
      if (!path.trim() || !rest.length || !rest.join('=').trim())
        fill(moreError, t('page.runs.not-an-assignment', {line: line.trim()}));
      else changes[path.trim()] = value(rest.join('='));
    }
    act.replace(changes);
  }

  /** @param {RunState} state @param {RunState | null} before */
  function update(state, before) {
    if (!state.spec) return;
    reset.hidden = Object.keys(state.changes).length === 0;
    for (const [path, {input}] of fields) input.classList.toggle('changed', path in state.changes);
    if (state.problem === before?.problem) return;
    const errors = new Map((state.problem?.errors ?? []).map((error) => [formField(state.spec, error.field), error]));
    for (const [path, {input, error}] of fields) {
      const wrong = errors.get(path);
      input.toggleAttribute('aria-invalid', Boolean(wrong));
      if (wrong) input.setAttribute('aria-invalid', 'true');
      fill(error, wrong ? explained(wrong) : null);
    }
    const first = [...fields].find(([path]) => errors.has(path));
    const fold = first?.[1].input.closest('details');
    if (fold) fold.open = true;
    first?.[1].input.focus();
  }

  return {element, build, update, has: (/** @type {string} */ path) => fields.has(path)};
}
