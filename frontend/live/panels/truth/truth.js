// Reality: how the simulated plant differs from the model that the observers and the detector know. Folded it is one
// line; unfolded it lies over the panels below it, so that nothing else moves.

import {fill, h} from '../../../common/dom.js';
import {AS_MODEL, complete, differences} from '../../../widgets/truth-differences.js';
import {heading, link, refusal} from '../../../widgets/controls.js';
import {t} from '../../../i18n/words.js';
import * as edits from './truth-edits.js';
import {dynamicsSection} from './truth-dynamics.js';
import {noiseSection, parameterSection, sensorSection} from './truth-sections.js';
import {TruthSource} from './truth-source.js';

/** @import {App} from '../../types.js' */
/** @import {Truth} from './truth-edits.js' */
/** @import {Section} from './truth-sections.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  /** @type {Section[]} */
  let sections = [];
  let open = false;
  /** @type {boolean[]} of each section */
  let unfolded = [];
  let started = false; // again, by a button of this panel, which the focus comes back to
  /** @type {string | null} the session whose truth this is */
  let session = null;
  const present = () => complete(app.state.facts?.truth);
  const source = new TruthSource({
    send: (truth) => app.send({type: 'set-truth', truth}),
    changed: () => show(),
    refused: (path, error) => fail(path, error),
  });
  const problem = h('p', {class: 'refused', role: 'alert'});
  const summary = h('span', {class: 'truth-summary', role: 'status'});
  const body = h('div', {class: 'truth-body scroll', id: 'truth-body'});
  const foot = h('div', {class: 'truth-foot control-only'});
  const toggle = link('', () => unfold(!open), {'aria-controls': body.id});

  /** @param {string} path @param {unknown} error */
  const fail = (path, error) => {
    const row = sections.flatMap(({rows}) => rows).find((one) => one.path === path);
    if (!row) return refusal(problem, error);
    row.fail(error);
    const fold = row.element.closest('details');
    if (fold) fold.open = true;
    return row.focus();
  };
  const forget = () => {
    refusal(problem, null);
    for (const row of sections.flatMap(({rows}) => rows)) row.fail(null);
  };
  /** Begin again from t = 0 with a truth; a refusal is shown at its fields. */
  const restart = async (/** @type {Truth} */ truth) => {
    const {spec} = app.state;
    if (!spec) return;
    forget();
    foot.setAttribute('aria-busy', 'true');
    try {
      await app.act.restart(edits.withTruth(spec, truth));
      started = true;
    } catch (error) {
      const {errors = []} = /** @type {{errors?: {field: string}[]}} */ (error);
      for (const one of errors.length ? errors : [error])
        fail(edits.pathOf(/** @type {{field?: string}} */ (one)), one);
    } finally {
      foot.removeAttribute('aria-busy');
    }
  };
  const asModel = () => {
    forget();
    source.discard();
    if (source.running.states.length > 0) return restart(AS_MODEL);
    return source.change('', () => AS_MODEL);
  };
  const back = link(t('page.truth.as-model-again'), asModel, {class: 'link control-only'});
  const start = h('button', {type: 'button', class: 'press', onclick: () => restart(source.shown)});
  const discard = link('', () => {
    forget();
    source.discard();
  });
  const waits = h('p', {class: 'soft'});

  const build = () => {
    const {plant, spec} = app.state;
    if (app.state.session !== session) source.reset(present());
    session = app.state.session;
    if (sections.length > 0) unfolded = sections.map((one) => one.element.open);
    sections = [];
    if (!plant || !spec) return fill(element);
    const context = {
      app,
      plant,
      spec,
      shown: () => source.shown,
      /** @type {TruthSource['change']} */
      change: (path, edit) => {
        refusal(problem, null);
        source.change(path, edit);
      },
    };
    sections = [
      ...(plant.parameters.length > 0 ? [parameterSection(context)] : []),
      noiseSection(context),
      ...(plant.outputs.length > 0 ? [sensorSection(context)] : []),
      dynamicsSection(context),
    ];
    back.textContent = t('page.truth.as-model-again');
    start.textContent = t('page.truth.start-again');
    discard.textContent = t('page.truth.discard');
    waits.textContent = t('page.truth.waits');
    fill(foot, problem, waits, h('div', {class: 'presses'}, start, discard));
    fill(
      body,
      h('p', {class: 'soft'}, t('page.truth.hidden')),
      back,
      sections.map((one) => one.element),
    );
    fill(element, heading(t('page.truth.title'), summary, toggle), body, foot);
    for (const [place, one] of sections.entries())
      one.element.open = differencesIn(one) || (unfolded[place] ?? place === 0);
    enable();
    unfold(open);
    if (started) toggle.focus();
    started = false;
  };
  /** @param {Section} one */
  const differencesIn = (one) => {
    one.follow(source.shown);
    return one.rows.some((row) => row.element.matches('.differs'));
  };
  /** @param {boolean} on */
  const unfold = (on) => {
    open = on;
    element.classList.toggle('open', open);
    toggle.textContent = open ? t('page.truth.fold') : t('page.truth.change');
    toggle.setAttribute('aria-expanded', String(open));
    show();
  };
  const show = () => {
    const {plant, spec} = app.state;
    if (!plant) return;
    const truth = source.shown;
    const parts = differences(truth, plant);
    const words = source.draft
      ? t('page.truth.draft', {parts})
      : parts.length
        ? t('page.truth.summary', {n: parts.length, parts})
        : t('page.truth.none');
    if (summary.textContent !== words) summary.textContent = words;
    summary.title = words;
    element.classList.toggle('differing', parts.length > 0);
    back.hidden = parts.length === 0;
    waits.hidden = discard.hidden = source.draft === null;
    start.classList.toggle('quiet-press', source.draft === null);
    start.hidden = edits.same(truth, edits.firstTruth(spec));
    for (const one of sections) one.follow(truth);
  };
  const enable = () => {
    for (const row of sections.flatMap(({rows}) => rows)) row.disable(app.state.role === 'view');
  };
  element.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !open || event.defaultPrevented) return;
    event.preventDefault();
    unfold(false);
    toggle.focus();
  });
  app.subscribe((state) => [state.plant, state.language, state.session], build);
  app.subscribe(
    (state) => state.facts,
    () => source.follow(present()),
  );
  app.subscribe((state) => state.spec, show);
  app.subscribe((state) => state.role, enable);
  app.subscribe(
    (state) => state.site,
    (site) => {
      if (site && open) unfold(false);
    },
  );
}
