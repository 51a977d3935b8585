// The cards on the right: always of the last text without errors, and they say so while the text has some.

import {fill, h} from '../../../common/dom.js';
import {drawPlant} from '../../../live/panels/plant/plant.js';
import {colourOf} from '../../../widgets/line-style.js';
import {named, t} from '../../../i18n/words.js';
import {chosenKinds, errorsOf} from '../store.js';
import {drawPreview} from './preview.js';
import {equationLine, fitted} from './equation-lines.js';
import {separation} from './separation.js';
import {mountParameters} from './parameters.js';

/** @import {App} from '../../../live/types.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {Editor, ShopActions, ShopState, ShopStore} from '../types.js' */

const USEFUL = 0.5; // error in faults of usual size above which no observer is recommended

/**
 * @param {HTMLElement} root
 * @param {ShopStore} store
 * @param {ShopActions} act
 * @param {Editor} editor
 * @param {(target: {field: 'dynamics' | 'outputs' | 'inputs', name: string}, anchor: HTMLElement) => void} point
 */
export function mountCards(root, store, act, editor, point) {
  const stale = h('p', {class: 'stale', role: 'status', hidden: true});
  /** @param {string} name @param {string} title */
  const card = (name, title) => {
    const head = h('div', {class: 'card-head'}, h('h2', {}, title));
    const body = h('div', {class: 'card-body'});
    return {head, body, element: h('section', {class: `card ${name}`, 'aria-label': title}, head, body)};
  };
  const plant = card('plant-card', t('page.workshop.plant'));
  const equations = card('equations-card', t('page.workshop.equations'));
  const parameters = card('parameters-card', t('page.workshop.parameters'));
  const preview = card('preview-card', t('page.workshop.preview'));
  const matrix = card('matrix-card', t('page.workshop.apart'));
  const observers = card('observers-card', t('page.workshop.observers'));
  fill(
    root,
    stale,
    h('div', {class: 'stack'}, plant.element, equations.element, parameters.element),
    h('div', {class: 'stack'}, preview.element, matrix.element, observers.element),
  );
  equations.head.append(h('span', {class: 'soft'}, t('page.workshop.equations.hint')));
  mountParameters(parameters, store, act);

  store.subscribe(
    (state) => [state.check, state.good],
    (state) => {
      const errors = errorsOf(state);
      stale.hidden = errors.length === 0 || state.good === null;
      stale.textContent = errors.length ? t('page.workshop.stale', {line: errors[0].place.line}) : '';
      root.classList.toggle('old', errors.length > 0);
    },
  );
  store.subscribe(
    (state) => [state.good, state.chosen, state.ranking],
    (state) => {
      const {good} = state;
      fill(
        plant.body,
        good?.plant ? picture(good.plant, state, editor) : h('p', {class: 'soft'}, t('page.workshop.nothing')),
      );
    },
  );
  store.subscribe(
    (state) => [state.good, state.check],
    (state) => {
      const warnings = state.check?.errors.filter((one) => one.severity === 'warning') ?? [];
      fill(
        equations.body,
        state.good?.equations &&
          lines(state.good.equations, warnings, point, state.good.plant?.time.kind !== 'discrete'),
      );
    },
  );
  store.subscribe(
    (state) => [state.trial, state.trialProblem, state.good],
    (state) => {
      fill(preview.body, drawPreview(state, store));
      fill(matrix.body, separation(state));
    },
  );
  store.subscribe(
    (state) => [state.ranking, state.chosen, state.kinds],
    (state) => fill(observers.body, ranking(state, store)),
  );
}

/** @param {service.Plant} plant @param {ShopState} state @param {Editor} editor */
function picture(plant, state, editor) {
  const observers = chosenKinds(state).map((kind, place) => ({
    kind,
    label: kind,
    colour: colourOf(place),
  }));
  const select = (/** @type {string | null} */ subject) => {
    if (!subject) return;
    const at = editor
      .text()
      .split('\n')
      .findIndex((line) => new RegExp(`name["']?:\\s*["']?${subject}\\b`).test(line));
    if (at >= 0) editor.select({line: at + 1, column: 1, length: editor.text().split('\n')[at].length});
  };
  const app = /** @type {App} */ (
    /** @type {unknown} */ ({state: {plant, observers, spec: null}, act: {site: select}})
  );
  return drawPlant(plant, app).svg;
}

/**
 * @param {service.PlantEquations} answer
 * @param {readonly service.TextError[]} warnings
 * @param {Parameters<typeof mountCards>[4]} point
 * @param {boolean} continuous   whether the equations of states are rates
 */
function lines(answer, warnings, point, continuous) {
  /**
   * @param {service.EquationLine} line
   * @param {'dynamics' | 'outputs' | null} field
   * @param {string} path   of its text
   */
  const row = (line, field, path) => {
    const wrong = warnings.find((one) => one.field === path);
    const about = wrong ? wrong.problem : [named(line.description), unitOf(line, field)].filter(Boolean).join(', ');
    const inner = [equationLine(line.math), h('span', {class: wrong ? 'wrong-unit' : 'soft'}, about)];
    const rows = wrong ? ' two-rows' : '';
    if (!field) return h('div', {class: `eq${rows}`}, inner);
    return h(
      'button',
      {
        type: 'button',
        class: `eq${rows}`,
        title: t('page.workshop.fault.add', {name: line.name}),
        'aria-label': t('page.workshop.fault.add', {name: line.name}),
        onclick: ({currentTarget}) => point({field, name: line.name}, currentTarget),
      },
      inner,
    );
  };
  /** @param {service.EquationLine} line @param {string | null} field */
  function unitOf({unit}, field) {
    return unit && field === 'dynamics' && continuous ? perSecond(unit) : unit;
  }
  return fitted(
    h(
      'div',
      {class: 'eqs'},
      answer.states.map((line) => row(line, 'dynamics', `dynamics.${line.name}`)),
      answer.definitions.map((line, place) => row(line, null, `definitions[${place}].expression`)),
      answer.outputs.map((line, place) => row(line, 'outputs', `outputs[${place}].expression`)),
      answer.controllers.map((line) => row(line, null, '')),
    ),
  );
}

/** The unit of a rate: m/s for m, rad/s² for rad/s. @param {string} unit */
const perSecond = (unit) =>
  unit.endsWith('/s') ? `${unit}²` : unit.endsWith('/s²') ? unit.replace(/²$/, '³') : `${unit}/s`;

/** @param {ShopState} state @param {ShopStore} store */
function ranking(state, store) {
  if (state.ranking === null) return h('p', {class: 'soft busy'}, t('page.workshop.ranking'));
  const fitting = state.ranking.filter((one) => one.possible);
  const others = state.ranking.filter((one) => !one.possible);
  const ticked = new Set(chosenKinds(state));
  const measured = fitting.length > 0 && fitting[0].error !== null && fitting[0].error < USEFUL;
  return [
    fitting.map((one, place) => {
      const tag =
        place === 0 && measured
          ? h('span', {class: 'tag best'}, t('page.workshop.best'))
          : ticked.has(one.kind) && place > 0
            ? h('span', {class: 'tag'}, t('page.workshop.compare'))
            : '';
      return h(
        'label',
        {class: 'ranked'},
        h('input', {
          type: 'checkbox',
          checked: ticked.has(one.kind),
          onchange: ({currentTarget}) => {
            const next = new Set(chosenKinds(store.state));
            if (currentTarget.checked) next.add(one.kind);
            else next.delete(one.kind);
            store.set({chosen: [...next]});
          },
        }),
        h('b', {}, state.kinds[one.kind] ?? one.kind),
        tag,
        h('span', {class: 'sub'}, one.why.text),
      );
    }),
    fitting.length === 0 && h('p', {class: 'soft'}, t('page.workshop.none-fits')),
    others.length > 0 &&
      h(
        'details',
        {class: 'others'},
        h('summary', {}, t('page.workshop.others', {n: others.length})),
        h(
          'ul',
          {},
          others.map((one) =>
            h('li', {}, h('b', {}, state.kinds[one.kind] ?? one.kind), h('span', {class: 'sub'}, one.why.text)),
          ),
        ),
      ),
  ];
}
