// The part of the strips that the step has yet to fill: hatched, with the question whose turn it is.

import {fill, h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import {Lesson} from './lesson.js' */

/**
 * Cover the strips from the present to the end of the step, until it is run. Returns the function that places it anew.
 * @param {HTMLElement} plots
 * @param {Lesson} lesson
 */
export function mountFuture(plots, lesson) {
  const {app} = lesson;
  const cover = h('div', {class: 'lesson-future', 'aria-hidden': 'true', hidden: true});
  plots.append(cover);
  const place = () => {
    const {selection, lesson: on} = app.state;
    const {place: axis} = app.scope;
    const waiting =
      lesson.view.phase !== 'running' && lesson.view.phase !== 'after' && lesson.step.run && on && selection && axis;
    cover.hidden = !waiting;
    if (!waiting) return;
    const canvas = plots.querySelector('canvas');
    const beside = canvas ? canvas.getBoundingClientRect().left - plots.getBoundingClientRect().left : 0;
    const [from, to] = selection;
    const share = Math.min(1, Math.max(0, (app.samples.now - from) / (to - from)));
    Object.assign(cover.style, {
      left: `${beside + axis.left + share * axis.width}px`,
      width: `${(1 - share) * axis.width}px`,
    });
    fill(cover, h('span', {}, t('page.lesson.your-turn')));
  };
  app.subscribe((state) => [state.selection, state.session, state.row, state.language], place);
  app.onTick(place);
  new ResizeObserver(place).observe(plots);
  return place;
}
