// One row of the inject panel: a fault of one channel, or of one output's measurement.

import {fill, h, number} from '../../../common/dom.js';
import {firstValues, limits, mainField, mainScale, ownFields, read, asTyped} from './fault-form.js';
import {badge, refusal, seconds, slider} from '../../../widgets/controls.js';
import {named, t} from '../../../i18n/words.js';

/** @import {App, BatchCommand, FaultInput, FaultState, State} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {FieldValue, Subject, TypedField, Values} from './fault-form.js' */

/**
 * @typedef {object} About
 * @property {string} title
 * @property {string} [description]
 * @property {string} kind
 * @property {[string, string]} badge
 * @property {service.FaultForm[]} shapes
 */

/**
 * A row with its form.
 * @typedef {object} InjectRow
 * @property {HTMLElement} element
 * @property {service.FaultForm} shape
 * @property {Values} values
 * @property {number | null} end        duration in s
 * @property {number | null} typed      the duration that was typed
 * @property {FaultState | null} active
 * @property {boolean} edited
 * @property {ReturnType<typeof slider> | null} main
 * @property {HTMLElement} [fold]
 * @property {(faults: FaultState[], role: State['role'], horizon: number | undefined) => void} show
 */

/**
 * A row for one channel or output. `subjectOf` is called whenever a form is built, since outputs move.
 * @param {App} app
 * @param {() => Subject} subjectOf
 * @param {About} about
 * @returns {InjectRow}
 */
export function createRow(app, subjectOf, about) {
  const subject = subjectOf();
  const menu = h(
    'select',
    {class: 'shape', 'aria-label': t('page.inject.shape-of', {title: about.title})},
    about.shapes.map((shape) =>
      h('option', {value: shape.shape, title: named(shape.description)}, shapeName(shape.shape)),
    ),
  );
  const control = h('div', {class: 'control'});
  const more = h('div', {class: 'more-fields'});
  const problem = h('p', {class: 'refused', role: 'alert'});
  const stack = h('p', {class: 'stack'});
  const sub = h('span', {class: 'sub'});
  const press = h('button', {type: 'button', class: 'press'});
  const change = h('button', {type: 'button', class: 'press quiet-press', hidden: true}, t('page.inject.change'));
  const element = h(
    'div',
    {class: 'fault', id: `fault-${subject.name}`, role: 'group', 'aria-label': about.title},
    badge(about.badge, {square: !subject.onChannel}),
    h('div', {class: 'name'}, h('b', {title: about.description}, about.title), sub),
    h('div', {class: 'presses'}, change, press),
    control,
    more,
    stack,
    problem,
  );
  /** @type {InjectRow} */
  const row = {
    element,
    shape: about.shapes[0],
    values: {},
    end: null,
    typed: null,
    active: null,
    edited: false,
    main: null,
    show,
  };

  const touch = () => {
    row.edited = row.active !== null;
    change.hidden = !row.edited;
    refusal(problem, null);
  };
  /** @param {Values | null} [values] @param {number | null} [end] */
  const build = (values = null, end = null) => {
    row.shape = about.shapes.find((shape) => shape.shape === menu.value) ?? about.shapes[0];
    const now = subjectOf();
    row.values = values ?? firstValues(row.shape, now);
    row.end = end;
    const field = mainField(row.shape);
    row.main = field && mainSlider(field, row, now, about.title, touch);
    const open = !row.fold?.hidden && row.fold !== undefined;
    const {summary, entries} = moreFields(row, field, touch);
    const dots = h(
      'button',
      {
        type: 'button',
        class: 'plain dots',
        'aria-expanded': String(open),
        'aria-label': t('page.inject.more-of', {title: about.title}),
        title: t('page.inject.more-of', {title: about.title}),
        onclick: () => {
          entries.hidden = !entries.hidden;
          dots.setAttribute('aria-expanded', String(!entries.hidden));
        },
      },
      '⋯',
    );
    row.fold = entries;
    entries.hidden = !open;
    fill(control, menu, row.main ? [row.main.range, row.main.field] : h('span', {class: 'stretch'}), dots);
    fill(more, summary, entries);
  };
  menu.addEventListener('change', () => {
    row.typed = null;
    build();
    touch();
  });

  /** @param {BatchCommand[]} commands */
  const ask = async (commands) => {
    refusal(problem, null);
    press.disabled = true;
    try {
      await app.act.together(commands);
      row.edited = false;
      change.hidden = true;
    } catch (error) {
      refusal(problem, error);
    } finally {
      press.disabled = app.state.role === 'view';
    }
  };
  const where = subject.onChannel ? {channel: subject.name} : {output: subject.name};
  /** @returns {BatchCommand} */
  const inject = () => {
    const end = row.end === null ? {} : {end: row.end};
    const fault = {...where, shape: row.shape.shape, onset: 0, ...end, ...row.values};
    return {type: 'inject', fault: /** @type {FaultInput} */ (/** @type {unknown} */ (fault))}; // by its form
  };
  control.addEventListener('keydown', (event) => {
    const input = event.target;
    if (event.key !== 'Enter' || !(input instanceof HTMLInputElement) || press.disabled) return;
    event.preventDefault();
    if (input.matches('.number')) input.dispatchEvent(new Event('change')); // typed text counts
    if (row.main?.field.matches('[aria-invalid]')) return;
    if (!row.active) press.click();
    else if (row.edited) change.click();
  });
  press.addEventListener('click', () => ask([row.active ? {type: 'clear', ...where} : inject()]));
  change.addEventListener('click', () => ask([{type: 'clear', ...where}, inject()]));

  /** `faults`: those on it that act, and those that are planned. */
  /** @type {InjectRow['show']} */
  function show(faults, role, horizon) {
    const acting = faults.filter(({active}) => active);
    const planned = faults.filter(({active}) => !active);
    const fault = acting.at(-1);
    const other = identity(fault) !== identity(row.active);
    row.active = fault ?? null;
    element.classList.toggle('on', Boolean(fault));
    fill(press, fault ? t('page.inject.clear') : t('page.inject.inject'));
    press.classList.toggle('clear', Boolean(fault));
    press.setAttribute('aria-label', t('page.inject.press', {action: press.textContent, title: about.title}));
    press.disabled = role === 'view';
    const beside = fault
      ? t('page.inject.since', {t: seconds(fault.onset, horizon)})
      : planned.length
        ? t('page.inject.planned-from', {t: seconds(Math.min(...planned.map(({onset}) => onset)), horizon)})
        : subject.unit;
    stack.textContent = fault ? stacked(acting, planned, horizon) : '';
    fill(sub, h('span', {class: 'kind'}, about.kind, beside && ' · '), beside);
    if (fault && other) adopt(row, menu, fault, build);
    // how long the last one lasted says nothing of the next
    if (!fault && row.end !== row.typed) build(row.values, row.typed);
    if (other) {
      row.edited = false;
      change.hidden = true;
    }
  }
  build();
  return row;
}

/**
 * The other faults that are active on the same channel and add up, and those that are planned.
 * @param {FaultState[]} acting
 * @param {FaultState[]} planned
 * @param {number | undefined} horizon
 */
function stacked(acting, planned, horizon) {
  /** @param {string} code @returns {(state: FaultState) => {code: string, args: {what: string, t: string}}} */
  const part =
    (code) =>
    ({fault, shape, onset}) => ({
      code,
      args: {
        what: 'size' in fault ? number(fault.size, 3) : shapeName(shape),
        t: seconds(onset, horizon),
      },
    });
  const steps = acting.length > 1 && acting.every(({shape, onChannel}) => shape === 'step' && onChannel);
  const sum = acting.reduce((total, {fault}) => total + ('size' in fault ? fault.size : 0), 0);
  return [
    acting.length > 1 && t('page.inject.together', {parts: acting.slice(0, -1).map(part('page.inject.part'))}),
    steps && t('page.inject.total', {size: number(sum, 3)}),
    planned.length > 0 && t('page.inject.planned', {parts: planned.map(part('page.inject.part-planned'))}),
  ]
    .filter(Boolean)
    .join(' ');
}

/** @param {string} shape */
const shapeName = (shape) => t(`page.fault.shape.${shape}`);
/** @param {string} field */
const fieldName = (field) => t(`page.fault.field.${field}`);

/**
 * What makes a fault itself: all but its end, which Clear sets.
 * @param {FaultState | null | undefined} state
 */
const identity = (state) => (state ? JSON.stringify({...state.fault, end: null}) : '');

/**
 * Show what acts: its shape and values, and the duration where it has one from the start.
 * @param {InjectRow} row
 * @param {HTMLSelectElement} menu
 * @param {FaultState} state
 * @param {(values?: Values | null, end?: number | null) => void} build
 */
function adopt(row, menu, {fault}, build) {
  menu.value = fault.shape;
  build();
  const known = /** @type {Values} */ (/** @type {unknown} */ (fault));
  const values = Object.fromEntries(
    ownFields(row.shape).map((field) => [field.name, known[field.name] ?? row.values[field.name]]),
  );
  build(values, fault.end === null || fault.end === undefined ? null : fault.end - fault.onset);
}

/**
 * @param {service.FormField} field
 * @param {InjectRow} row
 * @param {Subject} subject
 * @param {string} title
 * @param {() => void} touch
 */
function mainSlider(field, row, subject, title, touch) {
  const first = firstValues(row.shape, subject)[field.name];
  const control = slider({
    name: `${title}: ${fieldName(field.name)}`,
    scale: mainScale(field, subject, Number(first)),
    value: Number(row.values[field.name]),
    ...limits(field, subject),
    change: (value) => {
      row.values[field.name] = value;
      touch();
    },
  });
  control.range.title = named(field.description);
  control.field.title = `${fieldName(field.name)}${subject.unit ? `, ${subject.unit}` : ''}`;
  return control;
}

/**
 * The other fields, folded away, and a line that says their values.
 * @param {InjectRow} row
 * @param {service.FormField | null} main
 * @param {() => void} touch
 */
function moreFields(row, main, touch) {
  const rest = ownFields(row.shape).filter((field) => field !== main);
  const summary = h('p', {class: 'summary'});
  const show = () => {
    const values = rest.map((field) => `${fieldName(field.name)} ${short(row.values[field.name])}`);
    summary.textContent = [...values, row.end === null ? null : t('page.inject.lasts', {s: number(row.end, 3)})]
      .filter(Boolean)
      .join(' · ');
  };
  /**
   * @param {string} name
   * @param {string} title
   * @param {TypedField} field
   * @param {unknown} value
   * @param {(value: FieldValue) => void} set
   */
  const entry = (name, title, field, value, set) => {
    const id = `field-${Math.random().toString(36).slice(2, 8)}`;
    const input =
      field.type === 'choice'
        ? h(
            'select',
            {id},
            (field.choices ?? []).map((choice) => h('option', {selected: choice === value}, choice)),
          )
        : h('input', {
            id,
            type: 'text',
            value: asTyped(value),
            inputmode: field.type === 'array' ? 'text' : 'decimal',
            title: named(field.description),
            autocomplete: 'off',
            spellcheck: 'false',
          });
    input.addEventListener('change', () => {
      const typed = read(field, input.value);
      if (typed === undefined) return input.setAttribute('aria-invalid', 'true');
      input.removeAttribute('aria-invalid');
      set(typed);
      show();
      return touch();
    });
    return [h('label', {for: id}, title), input];
  };
  const entries = rest.map((field) =>
    entry(field.name, fieldName(field.name), field, row.values[field.name], (value) => {
      row.values[field.name] = value;
    }),
  );
  entries.push(
    entry(
      'end',
      t('page.fault.field.end'),
      {type: 'number', nullable: true, above: 0, description: t('page.inject.end.hint')},
      row.end,
      (value) => {
        row.end = row.typed = value === null ? null : Number(value);
      },
    ),
  );
  show();
  return {summary, entries: h('div', {class: 'entries'}, entries)};
}

/** @param {unknown} value @returns {string} */
const short = (value) =>
  Array.isArray(value) ? `${value.length}×` : typeof value === 'number' ? number(value, 3) : String(value ?? '');
