// The keys of a lesson: answers, run, steps, truth. They come before those of the live page.

import {lead} from '../class/lead.js';

/** @import {Lesson} from './lesson.js' */

/** @param {Lesson} lesson */
export function mountKeys(lesson) {
  document.addEventListener(
    'keydown',
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
      const at = event.target instanceof Element ? event.target : document.body;
      if (at.matches('input:not([type=range], [type=radio]), select, textarea')) return;
      if (at.matches('.sketch-pad') && /^(Home|End|Arrow)/.test(event.key)) return; // they draw
      if (at.matches('[role=button]') && [' ', 'Enter'].includes(event.key)) return; // a place in the picture
      const act = actionOf(lesson, event.key, at);
      if (!act) {
        if (OTHERS.has(event.key.toUpperCase())) event.stopPropagation(); // of the live page; not in a lesson
        return;
      }
      event.preventDefault();
      event.stopPropagation();
      act();
    },
    true,
  );
}

const OTHERS = new Set(['F', 'C', 'E', 'N', 'P', 'S', ' ', '.', 'HOME', 'END', '+', '-', '=']);

/**
 * @param {Lesson} lesson
 * @param {string} key
 * @param {Element} at
 * @returns {(() => unknown) | null}
 */
function actionOf(lesson, key, at) {
  const {step, view} = lesson;
  const count = step.answers?.length || step.choices?.length || 0;
  if (/^[1-9]$/.test(key))
    return Number(key) <= count && (view.phase === 'before' || view.phase === 'opening')
      ? () => lesson.choose(Number(key) - 1)
      : () => {};
  switch (key.length === 1 ? key.toUpperCase() : key) {
    case 'PageDown':
      return () => (view.phase === 'after' || !step.run || !lesson.ready() ? lesson.next() : lesson.run());
    case 'PageUp':
      return () => lesson.back();
    case 'Enter':
      if (at.matches('button, a, summary')) return null;
      return () => (view.phase === 'after' || !step.run ? lesson.next() : lesson.run());
    case 'H':
      return () => lesson.truth();
    case 'V':
      return lead.follows ? () => lead.show() : null;
    case 'P':
      return () => lesson.enlarge();
    default:
      return null;
  }
}
