// Reality: how the simulated plant differs from the model that the observers and the detector know. Folded it is one
// line; unfolded it lies over the panels below it, so that nothing else moves.

import {fill, h} from '../../../common/dom.js';
import {AS_MODEL, complete, differences} from '../../../widgets/truth-differences.js';
import {heading, link, refusal} from '../../../widgets/controls.js';
import {t} from '../../../i18n/words.js';
import {foldsAway} from '../unfolded.js';
import * as edits from './truth-edits.js';
import {dynamicsSection} from './truth-dynamics.js';
import {noiseSection, parameterSection, sensorSection} from './truth-sections.js';
import {TruthSource} from './truth-source.js';

/** @import {App} from '../../types.js' */
/** @import {Edit, Truth} from './truth-edits.js' */
/** @import {Section} from './truth-sections.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const panel = new TruthPanel(element, app);
  foldsAway(element, app, panel);
  app.subscribe(
    (state) => [state.plant, state.language, state.session],
    () => panel.build(),
  );
  app.subscribe(
    (state) => state.facts,
    () => panel.source.follow(panel.present),
  );
  app.subscribe(
    (state) => state.spec,
    () => panel.show(),
  );
  app.subscribe(
    (state) => state.role,
    () => panel.enable(),
  );
}

class TruthPanel {
  /** @param {HTMLElement} element @param {App} app */
  constructor(element, app) {
    this.element = element;
    this.app = app;
    /** @type {Section[]} */
    this.sections = [];
    this.open = false;
    /** @type {boolean[]} whether each section is unfolded */
    this.unfolded = [];
    /** Whether a button of this panel has started again: the focus comes back to the panel. */
    this.started = false;
    /** @type {string | null} the session whose truth this is */
    this.session = null;
    this.source = new TruthSource({
      send: (truth) => app.send({type: 'set-truth', truth}),
      changed: () => this.show(),
      refused: (path, error) => this.fail(path, error),
    });
    this.problem = h('p', {class: 'refused', role: 'alert'});
    this.summary = h('span', {class: 'truth-summary', role: 'status'});
    this.body = h('div', {class: 'truth-body scroll', id: 'truth-body'});
    this.foot = h('div', {class: 'truth-foot control-only'});
    this.toggle = link('', () => this.unfold(!this.open), {'aria-controls': this.body.id});
    this.back = link('', () => this.asModel(), {class: 'link control-only'});
    this.start = h('button', {type: 'button', class: 'press', onclick: () => this.restart(this.source.shown)});
    this.discard = link('', () => this.giveUp());
    this.waits = h('p', {class: 'soft'});
  }

  /** The truth of the session at the row that is shown. */
  get present() {
    return complete(this.app.state.facts?.truth);
  }

  get rows() {
    return this.sections.flatMap(({rows}) => rows);
  }

  /** Make all rows anew, for another plant or in another language; a draft stays while the session does. */
  build() {
    const {plant, session} = this.app.state;
    if (session !== this.session) this.source.reset(this.present);
    this.session = session;
    if (this.sections.length > 0) this.unfolded = this.sections.map((one) => one.element.open);
    this.sections = this.makeSections();
    if (!plant || this.sections.length === 0) return fill(this.element);
    this.back.textContent = t('page.truth.as-model-again');
    this.start.textContent = t('page.truth.start-again');
    this.discard.textContent = t('page.truth.discard');
    this.waits.textContent = t('page.truth.waits');
    fill(this.foot, this.problem, this.waits, h('div', {class: 'presses'}, this.start, this.discard));
    fill(
      this.body,
      h('p', {class: 'soft'}, t('page.truth.hidden')),
      this.back,
      this.sections.map((one) => one.element),
    );
    fill(this.element, heading(t('page.truth.title'), this.summary, this.toggle), this.body, this.foot);
    for (const [place, one] of this.sections.entries()) {
      one.follow(this.source.shown);
      const differs = one.rows.some((row) => row.element.matches('.differs'));
      one.element.open = differs || (this.unfolded[place] ?? place === 0);
    }
    this.enable();
    this.unfold(this.open);
    if (this.started) this.toggle.focus();
    this.started = false;
  }

  /** @returns {Section[]} */
  makeSections() {
    const {app, source} = this;
    const {plant, spec} = app.state;
    if (!plant || !spec) return [];
    const context = {
      app,
      plant,
      spec,
      shown: () => source.shown,
      change: (/** @type {string} */ path, /** @type {Edit} */ edit) => {
        refusal(this.problem, null);
        source.change(path, edit);
      },
    };
    return [
      ...(plant.parameters.length > 0 ? [parameterSection(context)] : []),
      noiseSection(context),
      ...(plant.outputs.length > 0 ? [sensorSection(context)] : []),
      dynamicsSection(context),
    ];
  }

  /** @param {boolean} on */
  unfold(on) {
    this.open = on;
    this.element.classList.toggle('open', on);
    this.toggle.textContent = on ? t('page.truth.fold') : t('page.truth.change');
    this.toggle.setAttribute('aria-expanded', String(on));
    this.show();
  }

  /** Show the truth: in one line, and in all rows. */
  show() {
    const {plant, spec} = this.app.state;
    if (!plant) return;
    const {shown: truth, draft} = this.source;
    const parts = differences(truth, plant);
    const words = draft
      ? t('page.truth.draft', {parts})
      : parts.length
        ? t('page.truth.summary', {n: parts.length, parts})
        : t('page.truth.none');
    if (this.summary.textContent !== words) this.summary.textContent = words;
    this.summary.title = words;
    this.back.hidden = parts.length === 0;
    this.waits.hidden = this.discard.hidden = draft === null;
    this.start.classList.toggle('quiet-press', draft === null);
    this.start.hidden = edits.same(truth, edits.firstTruth(spec));
    for (const one of this.sections) one.follow(truth);
  }

  /** Those who only watch change nothing. */
  enable() {
    for (const row of this.rows) row.disable(this.app.state.role === 'view');
  }

  /**
   * Show a refusal at the row that it is about, else below all rows.
   * @param {string} path
   * @param {unknown} error
   */
  fail(path, error) {
    const row = this.rows.find((one) => one.path === path);
    if (!row) return refusal(this.problem, error);
    row.fail(error);
    const fold = row.element.closest('details');
    if (fold) fold.open = true;
    row.focus();
    return row.element.scrollIntoView({block: 'nearest'}); // with the words of the refusal
  }

  forget() {
    refusal(this.problem, null);
    for (const row of this.rows) row.fail(null);
  }

  giveUp() {
    this.forget();
    this.source.discard();
  }

  /** Take all differences back; further states need a new start for it. */
  asModel() {
    this.giveUp();
    if (this.source.running.states.length > 0) return this.restart(AS_MODEL);
    return this.source.change('', () => AS_MODEL);
  }

  /**
   * Begin again from 0 s with a truth; refusals are shown at their rows.
   * @param {Truth} truth
   */
  async restart(truth) {
    const {spec} = this.app.state;
    if (!spec) return;
    this.forget();
    this.foot.setAttribute('aria-busy', 'true');
    try {
      await this.app.act.restart(edits.withTruth(spec, truth));
      this.started = true;
    } catch (error) {
      const {errors = []} = /** @type {{errors?: object[]}} */ (error);
      for (const one of errors.length ? errors : [error]) this.fail(edits.pathOf(/** @type {object} */ (one)), one);
    } finally {
      this.foot.removeAttribute('aria-busy');
    }
  }
}
