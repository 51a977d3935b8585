// A lesson on paper: figures and questions, or also the answers. The browser prints it or makes a PDF of it.

import {connection, get, post, reason} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {named, speak, t} from '../../i18n/words.js';
import {playedStrips} from '../../widgets/played-strips.js';
import {prose, withSymbols} from '../../widgets/prose.js';

/** @import * as service from '../../types/service.js' */
/** @import {Child} from '../../types/dom.js' */

const asked = new URLSearchParams(location.search);
const id = asked.get('lesson') ?? '';
let answers = asked.get('answers') === '1';

await speak(chosenLanguage());
/** @type {service.CourseLesson | null} */
let lesson = null;
/** @type {Map<number, service.Played>} */
const played = new Map();
let problem = '';

const draw = () => {
  document.title = lesson ? `${named(lesson.title)} · ${t('page.worksheet.title')}` : t('page.worksheet.title');
  fill(query('.skip'), t('page.nav.skip-to-lessons'));
  const ready = lesson !== null && played.size === lesson.steps.length;
  document.documentElement.dataset.ready = String(ready);
  fill(
    query('#main'),
    lesson && tools(ready),
    problem && h('p', {class: 'alarm', role: 'alert'}, problem),
    lesson && [
      h('h1', {}, named(lesson.title)),
      h('p', {class: 'lead'}, named(lesson.outcome)),
      !answers && h('p', {class: 'name-line'}, t('page.worksheet.name')),
      lesson.steps.map((step, place) => section(step, place)),
    ],
  );
};
/** @param {boolean} ready */
function tools(ready) {
  /** @param {boolean} value @param {string} words */
  const choice = (value, words) =>
    h('button', {type: 'button', 'aria-pressed': String(answers === value), onclick: () => choose(value)}, words);
  return h(
    'div',
    {class: 'worksheet-tools'},
    h(
      'div',
      {class: 'segments', role: 'group', 'aria-label': t('page.worksheet.title')},
      choice(false, t('page.worksheet.questions')),
      choice(true, t('page.worksheet.answers')),
    ),
    h('button', {type: 'button', class: 'run', onclick: () => print()}, t('page.worksheet.print')),
    !ready && h('span', {class: 'soft', role: 'status'}, t('page.worksheet.playing')),
  );
}

/** @param {boolean} value */
function choose(value) {
  answers = value;
  history.replaceState(null, '', `?lesson=${encodeURIComponent(id)}${value ? '&answers=1' : ''}`);
  draw();
}

/** @param {service.CourseStep} step @param {number} place */
function section(step, place) {
  const how = played.get(place);
  const deed = how?.deeds.find(({judged}) => judged.met && (step.right_if?.length ?? 0) > 0) ?? how?.deeds[0];
  return h(
    'section',
    {class: 'sheet'},
    h('h2', {}, `${place + 1} · `, named(step.title)),
    step.say.map((words) => h('p', {}, prose(named(words)))),
    how && playedStrips(how, step, {whole: answers}),
    step.ask && h('p', {class: 'ask'}, withSymbols(named(step.ask))),
    options(step, deed),
    step.dial && h('p', {}, named(step.dial.text), dialWords(step.dial)),
    !answers && (step.sketch ? h('p', {class: 'soft'}, t('page.worksheet.sketch')) : step.ask && lines()),
    answers && deed && key(step, deed),
  );
}

/** @param {service.Dial} dial */
const dialWords = ({solution, unit}) =>
  answers ? ` = ${solution}${unit ? ` ${unit}` : ''}` : ` = ______${unit ? ` ${unit}` : ''}`;

const lines = () => h('div', {class: 'lines', 'aria-hidden': 'true'});

/** @param {service.CourseStep} step @param {service.PlayedDeed | undefined} deed @returns {Child} */
function options(step, deed) {
  const all = step.answers?.length ? step.answers : (step.choices ?? []);
  const how = step.choices?.length && step.right_if?.length ? played.get(placeOf(step)) : undefined;
  const right = all.map((_, at) => (step.answers?.length ? deed?.judged.right[at] : how?.deeds[at]?.judged.met));
  return (
    all.length > 0 &&
    h(
      'ol',
      {class: 'boxes'},
      all.map(({text}, at) =>
        h(
          'li',
          {class: answers && right[at] ? 'right' : null},
          answers && right[at]
            ? h('span', {class: 'box', role: 'img', 'aria-label': t('page.worksheet.right')}, '✓')
            : h('span', {class: 'box', 'aria-hidden': 'true'}),
          h('span', {}, withSymbols(named(text))),
        ),
      ),
    )
  );
}

/** @param {service.CourseStep} step */
const placeOf = (step) => lesson?.steps.indexOf(step) ?? 0;

/** What was seen, and why. @param {service.CourseStep} step @param {service.PlayedDeed} deed */
function key(step, {judged}) {
  const saw = typeof judged.saw === 'number' ? step.saw?.[judged.saw] : undefined;
  return h(
    'div',
    {class: 'key'},
    saw && h('p', {}, prose(named(saw.text), judged.values)),
    step.why?.map((words) => h('p', {}, prose(named(words), judged.values))),
  );
}

mountTop(query('header'), connection, 'learn', draw);
try {
  lesson = /** @type {service.CourseLesson} */ (await get(`/api/course/${encodeURIComponent(id)}`));
  draw();
  for (let step = 0; step < lesson.steps.length; step += 1) {
    played.set(step, /** @type {service.Played} */ (await post('/api/course/play', {lesson, step})));
    draw();
  }
} catch (error) {
  problem = reason(error).message;
  draw();
}
