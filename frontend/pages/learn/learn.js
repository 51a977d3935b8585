// The overview of the course: where one was, what one can do afterwards, and the lessons.

import {connection, get} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {named, speak, t} from '../../i18n/words.js';
import {finished, places} from '../../live/lesson/progress.js';
import {played} from './mystery/place.js';
import {teacherCard} from './own-lessons.js';

/** @import * as service from '../../types/service.js' */
/** @import {Place} from '../../live/lesson/progress.js' */

/** @typedef {{lesson: service.CourseLine, place: Place | undefined}} Entry */

await speak(chosenLanguage());
const {lessons} = /** @type {service.CourseList} */ (await get('/api/course'));
const madeHere = async () => /** @type {service.MyLessonList} */ (await get('/api/my-lessons')).lessons;
let own = await madeHere();
const draw = () => {
  const kept = places();
  /** @type {Entry[]} */
  const entries = lessons.map((lesson) => ({lesson, place: kept[lesson.id]}));
  document.title = t('page.learn.page-title');
  fill(query('.skip'), t('page.nav.skip-to-lessons'));
  fill(
    query('#main'),
    h('div', {class: 'learn-intro'}, introduction(entries), outcomes(lessons), classCard()),
    h(
      'ol',
      {class: 'learn-lessons'},
      entries.map((entry) => h('li', {}, card(entry, entry === current(entries)))),
      h('li', {class: 'learn-mystery'}, mystery()),
      h('li', {class: 'wide'}, papersCard()),
      h('li', {class: 'wide'}, teacherCard(lessons, own, again)),
    ),
  );
};
const again = async () => {
  own = await madeHere();
  draw();
};
mountTop(query('header'), connection, 'learn', draw);
draw();

/** The lesson that one is in the middle of, the newest. @param {Entry[]} entries */
function current(entries) {
  const begun = entries.filter(({place}) => place && !finished(place));
  return begun.sort((a, b) => (b.place?.at ?? 0) - (a.place?.at ?? 0))[0];
}

/** @param {Entry[]} entries */
function introduction(entries) {
  const here = current(entries);
  const first = entries.find(({place}) => !finished(place)) ?? entries[0];
  const {lesson, place} = here ?? first;
  const words = here
    ? t('page.learn.continue', {n: lesson.number})
    : entries.some((entry) => entry.place)
      ? t('page.learn.begin-lesson', {n: lesson.number})
      : t('page.learn.begin', {minutes: lesson.minutes});
  return h(
    'section',
    {class: 'card'},
    h('h1', {}, t('page.learn.title')),
    h('p', {class: 'lead'}, t('page.learn.lead', {n: entries.length})),
    h('a', {class: 'run learn-go', href: addressOf(lesson)}, words),
    place &&
      !finished(place) &&
      h('p', {class: 'soft'}, t('page.learn.at', {title: named(lesson.title), n: place.step + 1, of: lesson.steps})),
  );
}

/** @param {readonly service.CourseLine[]} all */
function outcomes(all) {
  const minutes = all.reduce((sum, one) => sum + one.minutes, 0);
  return h(
    'section',
    {class: 'card learn-outcomes'},
    h(
      'div',
      {class: 'heading'},
      h('h2', {}, t('page.learn.about')),
      h('span', {class: 'soft'}, t('page.learn.minutes', {n: minutes})),
    ),
    h('p', {}, t('page.learn.observer')),
    h('p', {}, t('page.learn.detector')),
    h('p', {}, t('page.learn.colours')),
    h('p', {}, h('a', {href: '/'}, t('page.learn.to-live'))),
  );
}

/** @param {Entry} entry @param {boolean} here */
function card({lesson, place}, here) {
  const state = finished(place)
    ? h('span', {class: 'ok'}, t('page.learn.done'))
    : place && h('span', {}, t('page.learn.step', {n: place.step + 1, of: lesson.steps}));
  return h(
    'a',
    {class: here ? 'card learn-card here' : 'card learn-card', href: addressOf(lesson)},
    h('h2', {}, h('span', {class: 'soft'}, lesson.number), named(lesson.title)),
    h('p', {}, named(lesson.outcome)),
    h('p', {class: 'soft meta'}, state, h('span', {}, t('page.learn.minutes', {n: lesson.minutes}))),
  );
}

/** The code of a class, and the way to open a room. */
function classCard() {
  const code = h('input', {
    id: 'class-code',
    autocomplete: 'off',
    spellcheck: 'false',
    maxlength: 12,
    placeholder: 'HWRTKM',
    required: true,
  });
  return h(
    'section',
    {class: 'card learn-class'},
    h('h2', {}, t('page.learn.class')),
    h('label', {for: 'class-code'}, t('page.learn.class-code')),
    h(
      'form',
      {
        onsubmit: (event) => {
          event.preventDefault();
          location.href = `/join/${encodeURIComponent(code.value.trim())}`;
        },
      },
      code,
      h('button', {class: 'run', type: 'submit'}, t('page.join.join')),
    ),
    h('p', {}, h('a', {href: '/classroom/'}, t('page.learn.teach'))),
  );
}

/** After the lessons: a fault to be found without them. */
function mystery() {
  const {seeds, best} = played();
  return h(
    'a',
    {class: 'card learn-card', href: '/learn/mystery/'},
    h('span', {class: 'learn-question', 'aria-hidden': 'true'}, '?'),
    h('div', {}, h('h2', {}, t('page.mystery.card.title')), h('p', {}, t('page.mystery.card.say'))),
    h(
      'p',
      {class: 'soft'},
      h('span', {}, t('page.mystery.card.minutes')),
      seeds.length > 0 && h('span', {}, t('page.mystery.card.played', {n: seeds.length, best})),
    ),
  );
}

/** The pages of the papers. */
function papersCard() {
  return h(
    'a',
    {class: 'card learn-card', href: '/learn/papers/'},
    h('h2', {}, t('page.papers.card.title')),
    h('p', {}, t('page.papers.card.say')),
  );
}

/** @param {service.CourseLine} lesson */
function addressOf({id}) {
  return `/?lesson=${encodeURIComponent(id)}`;
}
