// A fault by pointing: patterns for one equation. The chosen one is written into the text immediately: its consequences
// are in sight; cancelling takes it out again.

import {fill, h, number, symbol} from '../../../common/dom.js';
import {mathml} from '../../../widgets/equations.js';
import {t} from '../../../i18n/words.js';
import {asProblem} from '../checks.js';
import * as service from '../service.js';

/** @import * as wire from '../../../types/service.js' */
/** @import {Editor, ShopStore} from '../types.js' */

const PAUSE = 350; // ms after the last key in a field

/**
 * @param {ShopStore} store
 * @param {Editor} editor
 * @returns {(target: {field: string, name: string}, anchor: HTMLElement) => Promise<void>}
 */
export function createPopover(store, editor) {
  /** @type {(() => void) | null} */
  let closeOpen = null;
  return async ({name}, anchor) => {
    closeOpen?.();
    const plant = store.state.good?.plant;
    if (!plant || !store.state.check?.valid) return;
    try {
      const {patterns} = await service.patterns({plant, name});
      closeOpen = show(store, editor, name, patterns, anchor);
    } catch (error) {
      store.set({problem: asProblem(error)});
    }
  };
}

/**
 * @param {ShopStore} store
 * @param {Editor} editor
 * @param {string} name
 * @param {readonly wire.FaultPattern[]} patterns
 * @param {HTMLElement} anchor
 * @returns {() => void} close it without a trace
 */
function show(store, editor, name, patterns, anchor) {
  const before = store.state.text;
  const terms = [...new Set(patterns.filter((one) => one.term && one.term !== name).map((one) => one.term))];
  let [term = ''] = terms;
  let [chosen] = offered();
  let latest = 0; // the last change of the text that was asked for
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  function offered() {
    return patterns.filter((one) => !one.term || one.term === name || one.term === term);
  }
  const nameField = h('input', {id: 'fault-name', oninput: soon});
  const titleField = h('input', {id: 'fault-title', oninput: soon});
  const sizeField = h('input', {id: 'fault-size', inputmode: 'decimal', oninput: soon});
  const [lowField, highField] = ['low', 'high'].map((end) =>
    h('input', {
      id: `fault-${end}`,
      inputmode: 'decimal',
      'aria-label': t(`page.workshop.fault.bounds.${end}`),
      placeholder: '–',
      oninput: soon,
    }),
  );
  const keep = h('input', {type: 'checkbox', onchange: apply});
  const kept = h('label', {class: 'conserve'}, keep, h('span'));
  const list = h('div', {class: 'patterns', role: 'radiogroup', 'aria-label': t('page.workshop.fault.patterns')});
  const verdict = h('span', {class: 'fault-verdict', role: 'status'});
  const box = h(
    'div',
    {class: 'fault-popover', role: 'dialog', 'aria-label': t('page.workshop.fault.add', {name}), onkeydown: keys},
    h(
      'div',
      {class: 'fault-head'},
      h('b', {}, t('page.workshop.fault.in')),
      symbol(name),
      terms.length > 0 && [
        h('label', {for: 'fault-term', class: 'soft'}, t('page.workshop.fault.of')),
        h(
          'select',
          {
            id: 'fault-term',
            onchange: ({currentTarget}) => {
              term = currentTarget.value;
              const same = offered().find((one) => one.pattern === chosen.pattern);
              choose(same ?? offered()[0]);
            },
          },
          terms.map((one) => h('option', {value: one}, one)),
        ),
      ],
      h('span', {class: 'grow'}),
      h(
        'button',
        {type: 'button', class: 'plain-button', 'aria-label': t('page.workshop.close'), onclick: cancel},
        '×',
      ),
    ),
    list,
    h(
      'div',
      {class: 'fault-form'},
      h('label', {for: 'fault-name'}, t('page.workshop.fault.name')),
      nameField,
      h('label', {for: 'fault-title'}, t('page.workshop.fault.title')),
      titleField,
      h('label', {for: 'fault-size'}, t('page.workshop.fault.size')),
      sizeField,
      h('label', {for: 'fault-low', title: t('page.workshop.fault.bounds.hint')}, t('page.workshop.fault.bounds')),
      h('span', {class: 'fault-bounds'}, lowField, ' … ', highField),
    ),
    kept,
    h(
      'div',
      {class: 'fault-foot'},
      verdict,
      h('span', {class: 'grow'}),
      h(
        'button',
        {type: 'button', class: 'quiet', onclick: cancel},
        t('page.workshop.cancel'),
        ' ',
        h('kbd', {}, 'Esc'),
      ),
      h('button', {type: 'button', class: 'run', id: 'add-fault', onclick: close}, t('page.workshop.fault.ok')),
    ),
  );

  function draw() {
    fill(
      list,
      offered().map((one) =>
        h(
          'button',
          {
            type: 'button',
            role: 'radio',
            'aria-checked': String(one === chosen),
            class: `pattern${one === chosen ? ' on' : ''}`,
            tabindex: one === chosen ? 0 : -1,
            onclick: () => choose(one),
          },
          h('span', {class: 'radio'}),
          h('b', {}, t(`page.workshop.fault.${one.pattern}`)),
          h('span', {class: 'soft'}, one.about.text),
          mathml(one.math),
        ),
      ),
    );
    const states = Object.keys(chosen.conserved);
    kept.hidden = states.length === 0;
    const words = kept.lastElementChild;
    if (words) words.textContent = t('page.workshop.fault.conserve', {names: states});
  }

  /** @param {wire.FaultPattern} pattern */
  function choose(pattern) {
    chosen = pattern;
    const {channel} = pattern;
    nameField.value = channel.name;
    titleField.value = t('page.workshop.fault.title-of', {
      pattern: t(`page.workshop.fault.${pattern.pattern}`).toLowerCase(),
      name: pattern.term || name,
    });
    sizeField.value = number(channel.typical).replace('−', '-');
    [lowField.value, highField.value] = channel.bounds.map((one) => (one === null ? '' : String(one)));
    keep.checked = false;
    draw();
    /** @type {HTMLElement | null} */ (list.querySelector('.on'))?.focus();
    apply();
  }

  function soon() {
    clearTimeout(timer);
    timer = setTimeout(apply, PAUSE);
  }

  async function apply() {
    clearTimeout(timer);
    const turn = (latest += 1);
    const {channel, conserved, states, parameters, equations} = chosen;
    const size = Number(sizeField.value);
    const {name: given, kind, enters, unit} = channel;
    const bounds = [lowField, highField].map((field, end) => boundIn(field, channel.bounds[end]));
    const written = {
      name: nameField.value.trim() || given,
      title: titleField.value.trim(),
      kind,
      enters: {...enters, ...(keep.checked ? conserved : {})},
      ...(unit ? {unit} : {}),
      typical: size > 0 ? size : channel.typical,
      ...(bounds.some((one) => one !== null) ? {bounds} : {}),
    };
    const plain = states.map(({name: own, unit: of, initial}) => ({name: own, ...(of ? {unit: of} : {}), initial}));
    const times = parameters.map(({name: own, value, unit: of, bounds: range}) => ({
      name: own,
      value,
      unit: of,
      bounds: range,
    }));
    try {
      const {text, lines} = await service.edit(before, {
        channels: [written],
        states: plain,
        parameters: times,
        equations,
      });
      if (turn !== latest || !box.isConnected) return;
      editor.setText(text, true);
      editor.mark(lines);
    } catch (error) {
      store.set({problem: asProblem(error)});
    }
  }

  /** @param {KeyboardEvent} event */
  function keys(event) {
    if (event.key === 'Escape') {
      event.preventDefault();
      cancel();
    } else if (event.key === 'Enter' && !(event.target instanceof HTMLButtonElement && event.target.role !== 'radio')) {
      event.preventDefault();
      close();
    } else if ((event.key === 'ArrowDown' || event.key === 'ArrowUp') && list.contains(document.activeElement)) {
      event.preventDefault();
      const all = offered();
      const step = event.key === 'ArrowDown' ? 1 : all.length - 1;
      choose(all[(all.indexOf(chosen) + step) % all.length]);
    }
  }

  function close() {
    latest += 1;
    box.remove();
    stop = true;
    document.querySelector('.eq.chosen')?.classList.remove('chosen');
    anchor.focus();
  }

  function cancel() {
    if (!box.isConnected) return;
    close();
    editor.setText(before, true);
    editor.mark([]);
  }

  let stop = false;
  store.subscribe(
    (state) => [state.check, state.trial],
    ({check, trial}) => {
      if (stop) return;
      const bad = check?.errors.find((one) => one.severity === 'error');
      verdict.classList.toggle('alarm', Boolean(bad));
      verdict.textContent = bad ? bad.problem : told(trial, nameField.value);
    },
  );
  anchor.closest('.eq')?.classList.add('chosen');
  document.body.append(box);
  choose(chosen);
  return cancel;
}

/**
 * The bound in a field, null of an empty one; where it holds no number it is marked, and the bound stays as it was.
 * @param {HTMLInputElement} field
 * @param {number | null} before
 */
function boundIn(field, before) {
  const text = field.value.trim().replace('−', '-');
  const value = text === '' ? null : Number(text);
  const wrong = value !== null && !Number.isFinite(value);
  field.setAttribute('aria-invalid', String(wrong));
  return wrong ? before : value;
}

/**
 * The time until the new fault is distinguished from all others.
 * @param {wire.PlantTrial | null} trial
 * @param {string} name
 */
function told(trial, name) {
  const names = Object.keys(trial?.preview.sizes ?? {});
  const row = trial?.preview.seconds[names.indexOf(name)];
  if (!row) return '';
  const worst = row.includes(null) ? null : Math.max(.../** @type {number[]} */ (row));
  return worst === null ? t('page.workshop.fault.mixed') : t('page.workshop.fault.told', {s: number(worst, 2)});
}
