// The step as a student sees it: the lesson's own card, before the answer, after a right one, after a wrong one.

import {fill, h} from '../../common/dom.js';
import {drawCard} from '../../live/lesson/card.js';
import {playedStrips} from '../../widgets/played-strips.js';
import {t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */
/** @import {Lesson} from '../../live/lesson/lesson.js' */

/** @typedef {'before' | 'right' | 'wrong'} Shown */

export class Preview {
  /** @param {HTMLElement} root */
  constructor(root) {
    this.root = root;
    /** @type {Shown} */
    this.shown = 'before';
    this.card = h('section', {class: 'card lesson-card', 'aria-labelledby': 'lesson-title'});
    /** @type {service.CourseLessonInput | null} */
    this.plan = null;
    this.place = 0;
    /** @type {service.Played | null} */
    this.played = null;
    this.problem = '';
  }

  /**
   * @param {service.CourseLessonInput} plan
   * @param {number} place
   * @param {service.Played | null} played   null: it is being computed
   * @param {string} problem
   */
  show(plan, place, played, problem) {
    Object.assign(this, {plan, place, played, problem});
    this.draw();
  }

  draw() {
    const {plan, place, played, shown} = this;
    const step = plan?.steps[place];
    if (!plan || !step) return fill(this.root);
    const deed = this.deed(shown);
    drawCard(this.card, this.seat(plan, step, deed));
    /** @param {Shown} value @param {string} words */
    const state = (value, words) =>
      h(
        'button',
        {
          type: 'button',
          'aria-pressed': String(shown === value),
          disabled: value !== 'before' && !this.deed(value),
          onclick: () => {
            this.shown = value;
            this.draw();
          },
        },
        words,
      );
    return fill(
      this.root,
      h(
        'div',
        {class: 'heading'},
        h('h2', {}, t('page.editor.preview')),
        h(
          'div',
          {class: 'segments', role: 'group', 'aria-label': t('page.editor.preview')},
          state('before', t('page.editor.before')),
          state('right', t('page.editor.right')),
          state('wrong', t('page.editor.wrong')),
        ),
      ),
      h('p', {class: 'soft'}, t('page.editor.preview.hint')),
      this.card,
      played &&
        h('div', {class: 'card preview-strips'}, playedStrips(played, step, {whole: shown !== 'before', width: 440})),
      h('p', {class: `verdict-line${this.sound() ? ' ok' : ''}`, role: 'status'}, this.verdict()),
    );
  }

  /** What a student did who is shown: an answer that is right or wrong. @param {Shown} shown */
  deed(shown) {
    const {played, plan, place} = this;
    const step = plan?.steps[place];
    if (!played?.deeds.length || !step || shown === 'before') return null;
    const wanted = shown === 'right';
    if (step.answers?.length) {
      const chosen = played.deeds[0].judged.right.indexOf(wanted);
      return chosen < 0 ? null : {judged: played.deeds[0].judged, chosen};
    }
    if (!step.right_if?.length) return wanted ? {judged: played.deeds[0].judged, chosen: null} : null;
    const at = played.deeds.findIndex(({judged}) => judged.met === wanted);
    return at < 0 ? null : {judged: played.deeds[at].judged, chosen: step.choices?.length ? at : null};
  }

  /**
   * What the card of a lesson asks its lesson for.
   * @param {service.CourseLessonInput} plan
   * @param {service.CourseStepInput} step
   * @param {{judged: service.Judged, chosen: number | null} | null} deed
   */
  seat(plan, step, deed) {
    const nothing = () => {};
    const right = () =>
      !deed
        ? null
        : step.answers?.length
          ? deed.judged.right[deed.chosen ?? 0]
          : step.right_if?.length
            ? deed.judged.met
            : null;
    return /** @type {Lesson} */ (
      /** @type {unknown} */ ({
        step,
        view: {
          plan,
          place: this.place,
          phase: deed ? 'after' : 'before',
          chosen: deed?.chosen ?? null,
          dial: step.dial?.value ?? null,
          sketch: null,
          judged: deed?.judged ?? null,
        },
        right,
        ready: () => true,
        choose: nothing,
        set: nothing,
        turn: nothing,
        next: nothing,
        again: () => this.back(),
        run: () => this.ahead(),
        pad: {element: {focus: nothing}},
      })
    );
  }

  back() {
    this.shown = 'before';
    this.draw();
  }

  ahead() {
    this.shown = this.deed('right') ? 'right' : 'before';
    this.draw();
  }

  /** Whether the step is sound: exactly one answer is right, a choice can be right and wrong, all get a sentence. */
  sound() {
    const {played, plan, place} = this;
    const step = plan?.steps[place];
    if (!played || !step || this.problem) return false;
    if (step.answers?.length && played.deeds[0]?.judged.right.filter(Boolean).length !== 1) return false;
    if (step.right_if?.length && new Set(played.deeds.map(({judged}) => judged.met)).size < 2) return false;
    return played.deeds.every(({judged}) => !step.saw?.length || judged.saw !== null);
  }

  verdict() {
    const {played, plan, place, problem} = this;
    const step = plan?.steps[place];
    if (problem) return problem;
    if (!played || !step) return t('page.editor.playing');
    const right = played.deeds[0]?.judged.right.filter(Boolean).length ?? 0;
    if (step.answers?.length && right !== 1) return t('page.editor.right-answers', {n: right});
    if (!this.sound()) return t('page.editor.not-sound');
    if (!step.answers?.length && !step.right_if?.length) return t('page.editor.asks-nothing');
    return t('page.editor.played', {n: step.answers?.length || played.deeds.length});
  }
}
