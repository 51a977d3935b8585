// A lesson beside a live session: the steps of the course, judged by what the student's own session shows.

import {get, post} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {lead} from '../class/lead.js';
import {drawCard} from './card.js';
import {mountCopyPicture} from './copy-picture.js';
import {drawBar, drawFoot} from './foot.js';
import {mountKeys} from './keys.js';
import {keepPlace, markDone, places} from './progress.js';
import {playStep} from './play-step.js';
import {remember, remembered} from './remember.js';
import {SketchPad} from './sketch-pad.js';
import {named, t} from '../../i18n/words.js';

/** @import {App, Experiment, SessionLink} from '../types.js' */
/** @import * as service from '../../types/service.js' */

/**
 * @typedef {object} View   what the card shows
 * @property {service.CourseLesson} plan
 * @property {number} place          of the step
 * @property {'opening' | 'before' | 'running' | 'after'} phase   opening: its session is not there yet
 * @property {number | null} chosen  place of the answer or choice
 * @property {number | null} dial    value of the dial
 * @property {number[] | null} sketch   what was drawn; null until something is
 * @property {number} mark           time of the session at which the step was started
 * @property {service.Judged | null} judged
 * @property {{label: string, t: number} | null} frozen   the observer whose divergence has stopped the step
 * @property {string} problem
 */

/** @typedef {{link: SessionLink, again: (of: string | null) => Promise<boolean>}} Opening */

/**
 * Show a lesson. `again` joins a session, or the one that the page had before it was loaded again, if it still exists.
 * @param {string} id
 * @param {App} app
 * @param {Opening} opening
 */
export async function startLesson(id, app, opening) {
  document.documentElement.classList.add('lesson');
  /** @type {service.CourseLesson} */
  let plan;
  try {
    plan = await get(`/api/course/${encodeURIComponent(id)}`);
  } catch (error) {
    document.documentElement.classList.remove('lesson');
    app.act.refused(error);
    return app.act.open(app.first);
  }
  const asked = Number(new URLSearchParams(location.search).get('step')) - 1;
  const place = Number.isInteger(asked) && asked >= 0 ? asked : (places()[id]?.step ?? 0);
  const lesson = new Lesson(app, opening, plan);
  return lesson.enter(Math.min(place, plan.steps.length - 1), true);
}

export class Lesson {
  /** @param {App} app @param {Opening} opening @param {service.CourseLesson} plan */
  constructor(app, opening, plan) {
    this.app = app;
    this.opening = opening;
    /** @type {View} */
    this.view = {
      plan,
      place: 0,
      phase: 'before',
      chosen: null,
      dial: null,
      sketch: null,
      mark: 0,
      judged: null,
      frozen: null,
      problem: '',
    };
    this.turns = 0;
    this.pad = new SketchPad(this);
    this.card = h('section', {class: 'card lesson-card', 'aria-labelledby': 'lesson-title', tabindex: -1});
    this.foot = h('footer', {class: 'lesson-foot'});
    this.bar = h('div', {class: 'lesson-bar'});
    this.picture = h('section', {class: 'card lesson-picture', hidden: true});
    this.cause = h('div', {class: 'lesson-cause', role: 'status', hidden: true});
    const main = query('#main');
    const centre = query('.centre', main);
    main.prepend(this.card);
    centre.prepend(this.picture, query('#panel-plant'), query('#hysteresis'), this.cause);
    centre.append(query('#panel-diagnosis'));
    main.before(this.bar);
    main.after(this.foot);
    app.onTick(() => {
      const clock = this.bar.querySelector('.clock');
      if (clock) clock.textContent = `${app.samples.now.toFixed(1)} s`;
    });
    mountCopyPicture(this.picture, app);
    mountKeys(this);
    lead.lesson = this;
    app.subscribe(
      (state) => [state.plant, state.columns],
      () => this.chooseStrips(),
    );
    app.subscribe(
      (state) => state.site,
      (site) => this.pointed(site),
    );
    app.subscribe(
      (state) => [state.language, state.lesson?.truth],
      () => this.draw(),
    );
  }

  get step() {
    return this.view.plan.steps[this.view.place];
  }

  /** @param {Partial<View>} change */
  set(change) {
    Object.assign(this.view, change);
    const {lesson} = this.app.state;
    const until = this.end();
    if (lesson && (lesson.until !== until || 'phase' in change))
      this.app.store.dispatch({type: 'set', lesson: {...lesson, until, sketch: this.curve(lesson.sketch?.at)}});
    this.draw();
  }

  /** Time of the session until which the step will run; null where it runs, has run, or has nothing to run. */
  end() {
    const {phase, mark} = this.view;
    const waiting = phase === 'opening' || phase === 'before';
    return waiting && this.step.run ? mark + this.step.run.seconds : null;
  }

  /**
   * What is drawn, or was, on its strip. `at`: the value that the keys move.
   * @param {number | null} [at]
   * @returns {import('../types.js').Sketched | null}
   */
  curve(at) {
    const {sketch, run} = this.step;
    const {phase, mark} = this.view;
    if (!sketch || !run || phase === 'opening') return null;
    const values = this.view.sketch ?? sketch.solution.map(() => sketch.value ?? 0);
    const bent = phase === 'before' ? (at ?? 1) : null;
    return {...sketch, values, from: mark, until: mark + run.seconds, at: bent};
  }

  /** Draw. @param {number[]} values @param {number} at @param {boolean} drawn   whether a value was changed */
  sketched(values, at, drawn) {
    const {lesson} = this.app.state;
    if (this.view.phase !== 'before' || !lesson) return;
    const first = drawn && this.view.sketch === null;
    if (drawn || this.view.sketch) this.view.sketch = values;
    this.app.store.dispatch({type: 'set', lesson: {...lesson, sketch: this.curve(at)}});
    if (first) this.draw(); // it can run now
  }

  /** A place of the picture was pointed at. @param {string | null} site */
  pointed(site) {
    const chosen = (this.step.answers ?? []).findIndex((answer) => answer.site && answer.site === site);
    if (chosen >= 0 && this.view.phase === 'before') this.set({chosen});
  }

  /** Choose an answer; one that is a place in the picture is marked there. @param {number} chosen */
  choose(chosen) {
    this.set({chosen});
    const site = this.step.answers?.[chosen]?.site;
    if (site) this.app.act.site(site);
  }

  draw() {
    lead.soon();
    drawCard(this.card, this);
    drawFoot(this.foot, this);
    drawBar(this.bar, this);
    const {frozen} = this.view;
    this.cause.hidden = frozen === null;
    if (frozen !== null)
      fill(
        this.cause,
        h('p', {}, t('page.lesson.frozen', {t: frozen.t.toFixed(1), label: frozen.label})),
        h('strong', {}, named(this.step.cause)),
      );
  }

  /**
   * Enter a step. `first`: the page has just been loaded, and may find its session again.
   * @param {number} place
   * @param {boolean} [first]
   */
  async enter(place, first = false) {
    const turn = (this.turns += 1);
    const {plan} = this.view;
    const step = plan.steps[place];
    keepPlace(plan.id, {step: place, of: plan.steps.length});
    const show = step.show;
    this.app.store.dispatch({
      type: 'set',
      lesson: {
        id: plan.id,
        place,
        truth: show?.truth ?? true,
        diagnosis: show?.diagnosis ?? false,
        line: step.dial?.strip ? {strip: step.dial.strip, at: step.dial.value} : (show?.line ?? null),
        sketch: null,
        sites: (step.answers ?? []).flatMap(({site}) => site ?? []),
        until: null,
      },
      looking: null,
      site: null,
    });
    document.documentElement.dataset.diagnosis = show?.diagnosis ? 'shown' : 'hidden';
    document.documentElement.dataset.picture = show?.picture ?? 'plant';
    query('#panel-plant').hidden = show?.picture !== undefined && show.picture !== 'plant';
    this.picture.hidden = show?.picture !== 'copy';
    this.set({
      place,
      phase: 'opening',
      chosen: null,
      dial: step.dial?.value ?? null,
      sketch: null,
      judged: null,
      frozen: null,
      problem: '',
    });
    if (first) {
      const kept = remembered(); // the history entry may name the session before it: it is written a little later
      const of = kept?.lesson === plan.id && kept.place === place ? kept.session : null;
      if ((await this.opening.again(of)) && (await this.found(turn))) return;
    } else remember(null);
    if (turn !== this.turns) return;
    if (step.start || first) await this.begin(place);
    else this.view.mark = this.app.samples.now;
    if (turn !== this.turns) return;
    this.set({phase: 'before'});
    this.chooseStrips();
    if (!first) query('h1', this.card).focus({preventScroll: true});
  }

  /**
   * After the page was loaded again: the session is there, and what was answered is remembered with it.
   * @param {number} turn
   */
  async found(turn) {
    const {place, plan} = this.view;
    const kept = remembered();
    const known = kept?.session === this.app.state.session && kept?.lesson === plan.id && kept.place === place;
    if (!kept || !known || turn !== this.turns) return false;
    this.set({phase: 'before', chosen: kept.chosen, dial: kept.dial, sketch: kept.sketch ?? null, mark: kept.mark});
    if (kept.dial !== null) this.turn(kept.dial);
    this.chooseStrips();
    if (kept.ran) await this.judge(turn);
    return true;
  }

  /**
   * Begin the session of a step, or of the last one before it that begins one.
   * @param {number} place
   */
  async begin(place) {
    const {plan} = this.view;
    const {start} = plan.steps.slice(0, place + 1).findLast((one) => one.start) ?? plan.steps[0];
    if (!start) return;
    const spec = /** @type {Experiment} */ (plan.experiments[start.experiment]); // the service finds its plant
    await new Promise((done) => {
      this.opening.link
        .begin({spec, t: start.t ?? 0, play: false, then: () => done(null)})
        .then(() => this.app.state.problem && done(null));
    });
    this.set({mark: start.t ?? 0});
  }

  /** Set the dial; a level moves on its strip. @param {number} value */
  turn(value) {
    const {lesson} = this.app.state;
    const {strip} = this.step.dial ?? {};
    this.view.dial = value;
    if (lesson && strip) this.app.store.dispatch({type: 'set', lesson: {...lesson, line: {strip, at: value}}});
  }

  /** Show the strips of the step, and the time until its end. */
  chooseStrips() {
    const {app, step} = this;
    if (!app.state.lesson || !app.state.plant) return;
    const wanted = step.show?.strips ?? [];
    const strips = wanted.length ? Object.fromEntries(app.strips().map(({name}) => [name, wanted.includes(name)])) : {};
    app.store.dispatch({type: 'set', strips});
    const end = this.view.mark + (step.run?.seconds ?? 0);
    if (end > 0) app.act.select(Math.max(0, this.view.mark - 2 * (step.run?.seconds ?? 0)), end);
  }

  /** Carry out the step: commands, then time; then judge it. */
  async run() {
    const {view, step, app} = this;
    if (!step.run || view.phase === 'running' || view.phase === 'opening' || !this.ready()) return;
    if (view.phase === 'after') return this.next();
    const turn = this.turns;
    this.set({phase: 'running', problem: '', mark: app.samples.now});
    this.chooseStrips();
    try {
      const frozen = await playStep(this, () => turn === this.turns);
      if (turn !== this.turns) return;
      this.view.frozen = frozen;
      remember({
        session: app.state.session ?? '',
        lesson: view.plan.id,
        place: view.place,
        chosen: view.chosen,
        dial: view.dial,
        sketch: view.sketch,
        mark: view.mark,
        ran: true,
      });
      await this.judge(turn);
      query('.feedback', this.card)?.focus({preventScroll: true});
    } catch (error) {
      if (turn !== this.turns) return;
      app.act.refused(error);
      this.set({phase: 'before'});
    }
  }

  /** @param {number} turn */
  async judge(turn) {
    const {plan, place, mark, dial, sketch} = this.view;
    const path = `/api/sessions/${encodeURIComponent(this.app.state.session ?? '')}/judge`;
    /** @type {service.Judged} */
    const judged = await post(path, {
      lesson: plan.id,
      step: place,
      mark,
      ...(dial === null ? {} : {dial}),
      ...(sketch === null ? {} : {sketch}),
    });
    if (turn !== this.turns) return;
    markDone(plan.id, place);
    this.set({phase: 'after', judged});
  }

  /** Whether it is shown on a projector. */
  get large() {
    return document.documentElement.classList.contains('lesson-large');
  }

  /** Large type for a projector, or again the usual one. */
  enlarge() {
    document.documentElement.classList.toggle('lesson-large');
    this.app.scope.restyle(); // its fonts are those of the page
    this.draw();
  }

  /** Whether the step can be run: where it asks, an answer was chosen. */
  ready() {
    if ((this.large || lead.follows) && !this.step.choices?.length) return true; // a lecturer asks the room
    const asks = (this.step.answers?.length ?? 0) > 0 || (this.step.choices?.length ?? 0) > 0;
    return (!asks || this.view.chosen !== null) && (!this.step.sketch || this.view.sketch !== null);
  }

  /** Whether the answer, the choice or the dial was right; null: nothing was asked. */
  right() {
    const {judged, chosen} = this.view;
    if (!judged) return null;
    if (this.step.answers?.length) return chosen === null ? null : judged.right[chosen];
    if (this.step.sketch && this.view.sketch === null) return null;
    return this.step.right_if?.length ? judged.met : null;
  }

  next() {
    const {plan, place} = this.view;
    if (!this.step.run) markDone(plan.id, place);
    if (place + 1 < plan.steps.length) return this.enter(place + 1);
    location.href = '/learn/';
    return undefined;
  }

  back() {
    const {place} = this.view;
    if (place > 0) return this.enter(place - 1);
    location.href = '/learn/';
    return undefined;
  }

  again = () => this.enter(this.view.place);

  /** Hide true states and faults, and the diagnosis, or show them. */
  truth() {
    const {lesson} = this.app.state;
    if (!lesson) return;
    const diagnosis = !lesson.truth && (this.step.show?.diagnosis ?? false);
    document.documentElement.dataset.diagnosis = diagnosis ? 'shown' : 'hidden';
    this.app.store.dispatch({type: 'set', lesson: {...lesson, truth: !lesson.truth, diagnosis}});
  }

  /** Open the session in Live, with everything in it. */
  async leave() {
    this.app.store.dispatch({type: 'set', lesson: null});
    location.href = `/${(await this.app.act.link()).replace(`${location.origin}/`, '')}`;
  }
}
