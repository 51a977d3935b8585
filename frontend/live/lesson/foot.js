// The foot of a lesson: back, the steps, truth, restart, everything in Live, next; on a projector the bar above it.

import {fill, h} from '../../common/dom.js';
import {lead} from '../class/lead.js';
import {places} from './progress.js';
import {named, t} from '../../i18n/words.js';

/** @import {Lesson} from './lesson.js' */

/** @param {HTMLElement} foot @param {Lesson} lesson */
export function drawFoot(foot, lesson) {
  const {view, app} = lesson;
  const {plan, place, phase} = view;
  const done = new Set(places()[plan.id]?.done ?? []);
  const count = plan.steps.length;
  /** @param {string} words @param {() => unknown} act @param {string} [key] */
  const button = (words, act, key) =>
    h('button', {type: 'button', class: 'quiet', onclick: act}, words, key && h('kbd', {}, key));
  const steps = plan.steps.map((step, at) =>
    h('button', {
      type: 'button',
      class: done.has(at) ? 'done' : null,
      'aria-current': at === place ? 'step' : null,
      'aria-label': t('page.lesson.step', {n: at + 1, of: count, title: named(step.title)}),
      title: named(step.title),
      onclick: () => lesson.enter(at),
    }),
  );
  const truth = app.state.lesson?.truth ?? true;
  fill(
    foot,
    button(t('page.lesson.back'), () => lesson.back()),
    h('nav', {class: 'lesson-steps', 'aria-label': t('page.lesson.steps')}, steps),
    h('span', {class: 'soft'}, t('page.lesson.place', {n: place + 1, of: count})),
    h('span', {class: 'grow'}),
    button(truth ? t('page.lesson.hide-truth') : t('page.lesson.show-truth'), () => lesson.truth(), 'H'),
    button(t('page.lesson.restart'), () => lesson.again()),
    button(t('page.lesson.open-live'), () => lesson.leave()),
    h('a', {class: 'quiet', href: `/worksheet/?lesson=${encodeURIComponent(plan.id)}`}, t('page.lesson.worksheet')),
    button(phase === 'after' || !lesson.step.run ? t('page.lesson.next') : t('page.lesson.skip'), () => lesson.next()),
  );
}

/**
 * The bar of a lesson on a projector, in place of header and foot: the place, the keys, the time.
 * @param {HTMLElement} bar
 * @param {Lesson} lesson
 */
export function drawBar(bar, {view, step}) {
  const {plan, place, phase} = view;
  /** @param {string} name @param {string} words */
  const key = (name, words) => h('span', {class: 'soft'}, h('kbd', {}, name), ' ', words);
  const runs = step.run && phase !== 'after';
  fill(
    bar,
    h('b', {}, named(plan.title)),
    h('span', {class: 'soft'}, t('page.lesson.place-short', {n: place + 1, of: plan.steps.length})),
    h('span', {class: 'grow'}),
    key('PgDn', runs ? t('page.lesson.key.run') : t('page.lesson.key.next')),
    lead.votes && key('V', t('page.lesson.key.votes')),
    key('H', t('page.lesson.key.truth')),
    key('P', t('page.lesson.key.small')),
    lead.votes && h('span', {}, t('page.class.voted', {n: lead.votes.voted, of: lead.votes.students})),
    h('span', {class: 'clock'}),
  );
}
