// For teachers: the lessons that were made here, worksheets, and copies to change.

import {request} from '../../common/api.js';
import {h} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */

/**
 * @param {readonly service.CourseLine[]} lessons   of the course
 * @param {readonly service.MyLessonLine[]} own
 * @param {() => unknown} again   loads and draws the page again
 */
export function teacherCard(lessons, own, again) {
  return h(
    'section',
    {class: 'card teach'},
    h(
      'div',
      {class: 'heading'},
      h('h2', {}, t('page.learn.make')),
      h('a', {href: '/lesson-editor/'}, t('page.learn.make')),
    ),
    h('p', {class: 'soft'}, t('page.learn.make.hint')),
    own.length > 0 && h('h3', {}, t('page.learn.mine')),
    own.length > 0 &&
      h(
        'ul',
        {class: 'teach-list'},
        own.map((one) => line(one, one.mine ? again : null)),
      ),
    h(
      'ul',
      {class: 'teach-list'},
      lessons.map((one) => line(one, null)),
    ),
  );
}

/** @param {service.CourseLine | service.MyLessonLine} one @param {(() => unknown) | null} again */
function line(one, again) {
  const id = encodeURIComponent(one.id);
  const title = named(one.title);
  return h(
    'li',
    {},
    h('a', {class: 'grow', href: `/?lesson=${id}`}, title),
    h('a', {class: 'soft', href: `/worksheet/?lesson=${id}`}, t('page.worksheet.title')),
    h('a', {class: 'soft', href: `/lesson-editor/?lesson=${id}`}, again ? t('page.learn.edit') : t('page.learn.copy')),
    again &&
      h(
        'button',
        {
          type: 'button',
          class: 'quiet',
          'aria-label': t('page.learn.delete.of', {title}),
          onclick: async () => {
            await request('DELETE', `/api/my-lessons/${id}`);
            again();
          },
        },
        t('page.learn.delete'),
      ),
  );
}
