// The votes of a class on the card of a lesson: how many have voted, and a bar for each answer once they are shown.

import {h} from '../../common/dom.js';
import {withSymbols} from '../../widgets/prose.js';
import {named, t} from '../../i18n/words.js';
import {lead} from './lead.js';

/** @import * as service from '../../types/service.js' */

/** How many have voted; nothing without a class. */
export function votesLine() {
  const {votes} = lead;
  if (!votes) return null;
  return h(
    'p',
    {class: 'votes-line', role: 'status'},
    t('page.class.voted', {n: votes.voted, of: votes.students}),
    ' · ',
    h('kbd', {}, 'V'),
    ' ',
    votes.shown ? t('page.class.hide') : t('page.class.show'),
  );
}

/** The votes for an answer, where they are shown. @param {number} place */
export function voteBar(place) {
  const {votes} = lead;
  if (!votes?.shown) return null;
  const count = votes.counts[place] ?? 0;
  const most = Math.max(1, ...votes.counts);
  return h(
    'span',
    {class: 'vote'},
    h('span', {class: 'vote-bar'}, h('span', {style: `width: ${(100 * count) / most}%`})),
    h('b', {}, count),
  );
}

/**
 * The votes after the step was run, right ones filled.
 * @param {service.CourseStep} step
 * @param {service.Judged | null} judged
 */
export function votesAfter(step, judged) {
  const {votes} = lead;
  if (!votes || !step.answers?.length) return null;
  return h(
    'ol',
    {class: 'votes-after'},
    step.answers.map(({text}, place) =>
      h(
        'li',
        {class: judged?.right[place] ? 'right' : null},
        h(
          'span',
          {},
          withSymbols(named(text)),
          judged?.right[place] && h('span', {class: 'ok'}, ` ✓ ${t('page.classroom.right')}`),
        ),
        voteBar(place),
      ),
    ),
  );
}
