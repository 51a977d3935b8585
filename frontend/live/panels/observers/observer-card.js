// One observer: its colour and name, the lights of its assumptions, its gains, a cross to remove it.

import {fill, h, symbol} from '../../../common/dom.js';
import {chip, refusal, seconds, slider, throttled} from '../../../widgets/controls.js';
import {gainScale} from '../../../widgets/slider-scale.js';
import {entriesOf, placeName, withEntry} from '../../state/gain-entries.js';
import {icon} from '../../../widgets/svg.js';
import {kindName} from '../../../widgets/kind-name.js';
import {beside, showLights} from './check-lights.js';
import {asSentence, named, t} from '../../../i18n/words.js';

/** @import {App, Check, Command, Event, Gain, ObserverState} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */

/** @typedef {{[name: string]: Gain | null}} Gains */
/**
 * One number of a gain.
 * @typedef {{gain: service.GainForm, place: number[], value: number | null, name: string}} Entry
 */
/** @typedef {ReturnType<typeof slider>} Control */

/**
 * A card with the functions that keep it up to date.
 * @typedef {object} Card
 * @property {HTMLElement} element
 * @property {string} label
 * @property {(next: ObserverState | undefined) => void} update
 * @property {(anew: boolean) => boolean} lacks    whether defaults are missing; `anew`: whether to ask the server
 * @property {(found: Gains, labels?: Record<string, service.GainLabels>) => void} defaults
 * @property {() => void} checks
 * @property {() => void} end
 * @property {(on: boolean) => void} unfold
 */

const SHOWN = 2; // gains that are always visible

/**
 * Every number of the gains that a running observer takes: one for each entry of a column or a matrix.
 * @param {service.ObserverKind} kind
 * @param {Gains} gains
 * @param {Record<string, service.GainLabels>} labels
 * @returns {Entry[]}
 */
function entries(kind, gains, labels) {
  return kind.gains
    .filter((gain) => gain.live !== false)
    .flatMap((gain) =>
      entriesOf(gains[gain.name] ?? gain.default).map(({place, value}) => ({
        gain,
        place,
        value,
        name: placeName(place, labels[gain.name]),
      })),
    );
}

/**
 * @param {App} app
 * @param {ObserverState} observer
 * @param {service.ObserverKind} kind
 */
export function createCard(app, observer, kind) {
  let present = observer;
  /** @type {Gains} defaults from the server */
  let known = {};
  /** @type {Record<string, service.GainLabels>} of the rows and columns of gains, from the server */
  let labels = {};
  const lights = h('button', {type: 'button', class: 'lights', 'aria-expanded': 'false'});
  const checks = h('ul', {class: 'checks', popover: 'auto', tabindex: 0}); // over the page: opened, it moves nothing
  lights.popoverTargetElement = checks;
  const gains = h('div', {class: 'gains'});
  const more = h('div', {class: 'gains'});
  const fold = h('details', {class: 'fold', hidden: true}, h('summary', {}, t('page.observers.more-gains')), more);
  const problem = h('p', {class: 'refused', role: 'alert'});
  const fallen = h('div', {class: 'fallen', hidden: true});
  const cross = h(
    'button',
    {
      type: 'button',
      class: 'plain control-only',
      title: t('page.observers.remove', {label: observer.label}),
      'aria-label': t('page.observers.remove', {label: observer.label}),
    },
    icon('close', 13),
  );
  const unfold = h(
    'button',
    {
      type: 'button',
      class: 'unfold',
      title: t('page.observers.gains-of-kind', {label: observer.label, kind: kindName(kind)}),
      onclick: () => open(body.matches('[hidden]'), true),
    },
    h('b', {}, observer.label),
  );
  const colour = chip(observer.colour, observer.dashed);
  const converging = h('span', {class: 'converging', hidden: true}, t('page.observers.converging'));
  converging.title = t('page.observers.converging.hint');
  const body = h('div', {class: 'tuning'}, gains, fold);
  let chosen = false; // opened or closed by hand
  let listed = false; // the checks
  /** @param {boolean} on @param {boolean} [byHand] */
  const open = (on, byHand = false) => {
    chosen ||= byHand;
    body.hidden = !on;
    unfold.setAttribute('aria-expanded', String(on));
  };
  const element = h(
    'section',
    {class: 'observer', 'aria-label': observer.label},
    h(
      'div',
      {class: 'observer-head'},
      colour,
      unfold,
      h('span', {class: 'kind soft', title: `${named(kind.title)}. ${kind.source}`}, kindName(kind)),
      converging,
      lights,
      cross,
    ),
    checks,
    fallen,
    body,
    problem,
  );
  /** @type {Map<string, Control>} */
  const controls = new Map();
  let built = ''; // the numbers that have controls
  cross.addEventListener('click', () => ask({type: 'remove-observer', label: observer.label}));
  checks.addEventListener('beforetoggle', ({newState}) => {
    if (newState === 'open') beside(lights, checks, /** @type {HTMLElement} */ (element.closest('.card')));
    lights.setAttribute('aria-expanded', String(newState === 'open'));
    listed = newState === 'open';
    card.checks();
  });
  /** @param {Command} command */
  const ask = async (command) => {
    try {
      await app.send(command);
      refusal(problem, null);
    } catch (error) {
      refusal(problem, error);
      show(true);
    }
  };
  /** @param {NonNullable<Check['gains']>} proposed */
  const take = async (proposed) => {
    for (const [gain, value] of Object.entries(proposed))
      await ask({type: 'set-gain', observer: observer.label, gain, value: [...value]});
  };
  /** @returns {Gains} */
  const values = () => ({...known, ...present.gains});
  /** @param {boolean} [force] */
  const show = (force = false) => {
    const now = entries(kind, values(), labels);
    const names = now.map(({gain, place, name}) => `${gain.name}.${place}.${name}`).join();
    if (built !== names) build(now, names);
    for (const {gain, place, value} of now) {
      const control = controls.get(`${gain.name}.${place}`);
      if (control && value !== null && value !== undefined && control.value !== value)
        control[force ? 'show' : 'follow'](value);
    }
  };
  /** @param {Entry[]} now @param {string} names */
  const build = (now, names) => {
    controls.clear();
    built = names;
    const scalars = now.filter((one) => one.gain.size === null);
    const first = scalars.length ? scalars.slice(0, SHOWN) : now.filter((one) => one.gain === now[0].gain).slice(0, 4);
    /** @param {Entry} one */
    const line = (one) => gainLine(observer.label, one, controls, () => values()[one.gain.name] ?? [], ask);
    fill(gains, first.map(line));
    const rest = now.filter((one) => !first.includes(one));
    fill(more, rest.map(line));
    fold.hidden = rest.length === 0;
  };
  /** @type {Card} */
  const card = {
    element,
    label: observer.label,
    update(next) {
      present = next ?? present;
      colour.classList.toggle('dashed', present.dashed);
      fill(fallen, present.diverged && fall(app, present));
      fallen.hidden = !present.diverged;
      converging.hidden = !app.state.converging.includes(observer.label);
      show();
      card.checks();
    },
    lacks: (anew) =>
      kind.gains.some(
        (gain) =>
          gain.live !== false &&
          !(gain.name in present.gains) &&
          (anew || !(gain.name in known)) &&
          gain.default === null,
      ),
    defaults(found, named = {}) {
      known = {...found};
      labels = {...named};
      show();
    },
    checks() {
      showLights(lights, checks, app.state.checks[observer.label] ?? [], listed ? take : null);
      for (const control of controls.values()) control.disable(app.state.role === 'view');
      cross.hidden = app.state.role === 'view';
    },
    end() {
      element.remove();
    },
    unfold(on) {
      if (!chosen) open(on);
    },
  };
  return card;
}

/**
 * Where and why it diverged, the remedy, and a button that restarts it with its present gains.
 * @param {App} app
 * @param {ObserverState} observer
 */
function fall(app, {label, config, gains, diverged}) {
  const cause = asSentence(diverged?.cause);
  /** @param {MouseEvent & {currentTarget: HTMLButtonElement}} event */
  const again = async (event) => {
    event.currentTarget.disabled = true;
    try {
      await app.act.together([
        {type: 'remove-observer', label},
        {type: 'add-observer', observer: {...config, gains}},
      ]);
    } catch (error) {
      app.act.refused(error);
    }
  };
  return [
    h(
      'p',
      {class: 'alarm small'},
      t('page.observers.diverged', {t: seconds(diverged?.t ?? 0, app.state.spec?.horizon), cause}),
    ),
    app.state.broken === null &&
      h(
        'button',
        {
          type: 'button',
          class: 'press quiet-press control-only',
          title: t('page.observers.restart.hint'),
          onclick: again,
        },
        t('page.observers.restart'),
      ),
  ];
}

/**
 * A slider for one number of a gain; sent while it moves.
 * @param {string} label
 * @param {Entry} entry
 * @param {Map<string, Control>} controls
 * @param {() => Gain} whole
 * @param {(command: Command) => Promise<void>} ask
 */
function gainLine(label, {gain, place, value, name}, controls, whole, ask) {
  if (value === null || value === undefined) {
    return h(
      'div',
      {class: 'gain', title: named(gain.meaning)},
      gainSymbol(gain, place, name),
      h('span', {class: 'soft'}, '…'),
    );
  }
  const send = throttled((/** @type {number} */ next) => {
    return ask({type: 'set-gain', observer: label, gain: gain.name, value: withEntry(whole(), place, next)});
  }, 160);
  const control = slider({
    name: `${label}: ${gain.symbol || gain.name}${name && ` ${name}`}, ${named(gain.meaning)}`,
    scale: gainScale(gain, value),
    value,
    low: gain.low ?? undefined,
    high: gain.high ?? undefined,
    positive: gain.positive,
    change: send,
  });
  controls.set(`${gain.name}.${place}`, control);
  return h(
    'div',
    {class: 'gain', title: [named(gain.meaning), gain.unit].filter(Boolean).join(', ')},
    gainSymbol(gain, place, name),
    control.range,
    control.field,
  );
}

/** @param {service.GainForm} gain @param {number[]} place @param {string} name */
function gainSymbol(gain, place, name) {
  const base = gain.symbol ? h('i', {}, gain.symbol) : symbol(gain.name);
  const count = place.map((index) => index + 1).join(',');
  return h('span', {class: 'math', title: name}, base, place.length ? h('sub', {}, count) : null);
}
