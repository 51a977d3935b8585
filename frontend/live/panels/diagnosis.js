// The diagnosis: the summary, then a line for each finding: its size, interval, onset and delay; and what is
// detectable.

import {childrenOf, fill, h} from '../../common/dom.js';
import {called, capital, spoken} from '../../common/names.js';
import {line, summarySentence} from '../../diagnosis/finding-line.js';
import {findings, stateOf} from '../../diagnosis/findings.js';
import {wholeLines} from '../../widgets/whole-lines.js';
import {heading, link, seconds} from '../../widgets/controls.js';
import {createSeen} from '../../diagnosis/detectability.js';
import {unresolved} from '../../diagnosis/fault-size.js';
import {createSure} from '../../diagnosis/confidence.js';
import {asSentence, t} from '../../i18n/words.js';

/** @import {App, State} from '../types.js' */

/** @type {{[name: string]: () => string}} */
const TITLES = {
  detectability: () => t('page.diagnosis.detectability'),
  certainty: () => t('page.diagnosis.certainty'),
};

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const verdict = h('p', {class: 'verdict', role: 'status'});
  const list = h('div', {class: 'scroll', role: 'region', tabindex: 0});
  const folds = {detectability: createSeen(app), certainty: createSure(app)};
  const more = wholeLines(list, () => childrenOf(list), app);
  const tag = h('span', {class: 'as-of-now', hidden: true});
  const behind = createBehind(app);
  /** @type {{[name: string]: HTMLButtonElement}} */
  let links = {};
  const build = () => {
    links = Object.fromEntries(
      Object.keys(folds).map((name) => [name, link(TITLES[name](), () => open(name), {'aria-expanded': 'false'})]),
    );
    list.setAttribute('aria-label', t('page.diagnosis.findings'));
    fill(
      element,
      heading(t('page.diagnosis.title'), tag, h('span', {class: 'heading-links'}, Object.values(links))),
      verdict,
      Object.values(folds).map((fold) => fold.element),
      list,
      more,
      behind.element,
    );
    open(null);
    update();
  };
  /**
   * One fold at a time; beside the scope it lies over the column, from the findings on down, so that nothing moves.
   * @param {string | null} name
   */
  const open = (name) => {
    for (const [one, {element: fold, show}] of Object.entries(folds)) {
      fold.hidden = one !== name || !fold.hidden;
      links[one].setAttribute('aria-expanded', String(!fold.hidden));
      if (!fold.hidden) show();
    }
    element.classList.toggle(
      'unfolded',
      Object.values(folds).some((fold) => !fold.element.hidden),
    );
    place();
  };
  const place = () => {
    if (!element.classList.contains('unfolded')) return;
    const column = (element.parentElement ?? element).getBoundingClientRect();
    element.style.setProperty('--below', `${verdict.offsetTop + verdict.offsetHeight}px`);
    element.style.setProperty('--room', `${column.bottom - verdict.getBoundingClientRect().bottom - 8}px`);
  };
  element.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !element.classList.contains('unfolded')) return;
    event.preventDefault();
    const [name] = Object.entries(folds).find(([, fold]) => !fold.element.hidden) ?? [];
    open(null);
    if (name) links[name].focus();
  });
  addEventListener('resize', place);
  const update = () => {
    const state = momentary(app.state);
    const {facts} = state;
    if (!state.plant || !facts) return;
    const all = findings({...state, facts});
    const words = summarySentence(facts.summary, {state});
    tag.hidden = state.past === null;
    tag.textContent = state.past && t('page.diagnosis.then', {t: seconds(facts.t, state.spec?.horizon)});
    behind.update();
    if (verdict.textContent !== words) verdict.textContent = words;
    const weak = state.broken === null && !state.past ? weakness(state) : '';
    const lost = state.broken === null ? state.observers.filter((one) => one.diverged) : [];
    fill(
      list,
      all.map((one) => line(one, {state})),
      all.length > 0 &&
        lost.map((one) =>
          h(
            'p',
            {class: 'hint'},
            h('span', {class: 'light bad'}),
            h(
              'span',
              {},
              t('page.diagnosis.observer-diverged', {
                label: one.label,
                t: seconds(one.diverged?.t ?? 0, state.spec?.horizon),
              }),
            ),
          ),
        ),
      weak &&
        h(
          'p',
          {class: 'hint'},
          h('span', {class: 'light open'}),
          h('button', {type: 'button', class: 'plain-words', onclick: () => open('detectability')}, weak),
        ),
      all.length === 0 &&
        state.broken === null &&
        state.plant.channels.length > 0 &&
        !state.spec?.truth?.record &&
        h(
          'p',
          {class: 'soft'},
          state.plant.inputs.length ? t('page.diagnosis.invite') : t('page.diagnosis.invite-outputs'),
        ),
    );
    for (const fold of Object.values(folds)) if (!fold.element.hidden) fold.show();
    place();
  };
  app.subscribe((state) => [state.language, state.session], build);
  app.subscribe(
    (state) => [
      state.plant,
      state.alarms,
      state.faults,
      state.diagnosis,
      state.role,
      state.observers,
      state.broken,
      state.facts,
      state.past,
    ],
    update,
  );
  app.onTick(behind.update);
}

/**
 * The state with the facts of the time that is looked back to.
 * @param {State} state
 * @returns {State}
 */
function momentary(state) {
  if (state.past === null) return state;
  const {facts, faults, alarms, broken} = stateOf(state.past);
  const running = new Map(facts.observers.map((one) => [one.label, one]));
  const observers = state.observers.map((one) => ({...one, ...running.get(one.label)}));
  return {...state, facts, faults, alarms, broken, observers, t: facts.t};
}

/**
 * Up to where the detector has judged, while it is a decision or more behind.
 * @param {App} app
 */
function createBehind(app) {
  const words = h('span');
  const element = h('p', {class: 'behind', hidden: true}, h('span', {class: 'hatched', 'aria-hidden': 'true'}), words);
  const update = () => {
    const {state, samples} = app;
    const judged = state.past ? null : (state.facts?.judged ?? null);
    const late = judged === null ? 0 : samples.now - judged;
    element.hidden = judged === null || late < state.record;
    if (element.hidden) return;
    const horizon = state.spec?.horizon;
    const args = {t: seconds(judged ?? 0, horizon), behind: seconds(late, horizon)};
    const {speed, playing} = state;
    const sentence =
      playing && speed !== null && speed !== 1
        ? t('page.diagnosis.behind-at', {...args, speed: `${speed}×`})
        : t('page.diagnosis.behind', args);
    if (words.textContent !== sentence) words.textContent = sentence;
  };
  return {element, update};
}

/**
 * The faults that cannot be distinguished now, not even of typical size; '' where all can.
 * @param {State} state
 */
function weakness(state) {
  const lost = unresolved(state);
  const {excitation, resolution = []} = state.diagnosis ?? {};
  if (!excitation || lost.length === 0) return '';
  if (lost.every((one) => one.smallest !== null))
    return capital(t('page.diagnosis.unresolved', {names: lost.map((one) => called(one.channel, state.plant))}));
  const whole = lost.length === resolution.filter((one) => !one.identifiable && !one.resolvable).length;
  return (whole ? [excitation] : lost).map((one) => asSentence(spoken(one.text, state.plant))).join(' ');
}
