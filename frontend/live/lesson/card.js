// The card of a lesson: words, question, answers; after the run what was said, what was seen, and why.

import {fill, h} from '../../common/dom.js';
import {explainSymbols} from './symbols.js';
import {prose, withSymbols} from '../../widgets/prose.js';
import {slider} from '../../widgets/controls.js';
import {logarithmic} from '../../widgets/slider-scale.js';
import {named, t} from '../../i18n/words.js';
import {voteBar, votesAfter, votesLine} from '../class/votes.js';

/** @import {Child} from '../../types/dom.js' */
/** @import {Lesson} from './lesson.js' */
/** @import * as service from '../../types/service.js' */

/** @param {HTMLElement} card @param {Lesson} lesson */
export function drawCard(card, lesson) {
  const {view, step} = lesson;
  const {plan, phase} = view;
  const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.keep : undefined;
  fill(
    card,
    h(
      'p',
      {class: 'eyebrow'},
      plan.number ? t('page.lesson.of', {n: plan.number, title: named(plan.title)}) : named(plan.title),
    ),
    h('h1', {id: 'lesson-title', tabindex: -1}, named(step.title)),
    phase === 'after' ? after(lesson) : before(lesson),
    h('div', {class: 'lesson-act'}, buttons(lesson)),
  );
  explainSymbols(card);
  card.setAttribute('data-phase', phase);
  if (focused) /** @type {HTMLElement | null} */ (card.querySelector(`[data-keep="${focused}"]`))?.focus();
}

/** @param {Lesson} lesson @returns {Child[]} */
function before(lesson) {
  const {step} = lesson;
  return [
    h(
      'div',
      {class: step.short ? 'say long' : 'say'},
      step.say.map((words) => h('p', {}, prose(named(words)))),
    ),
    step.short && h('p', {class: 'say short'}, prose(named(step.short))),
    step.ask && h('p', {class: 'ask', id: 'lesson-ask'}, withSymbols(named(step.ask))),
    (step.answers?.length ?? 0) > 0 && votesLine(),
    (step.answers?.length ?? 0) > 0 && (points(step) ? pointing(lesson) : options(lesson, step.answers ?? [])),
    (step.choices?.length ?? 0) > 0 && options(lesson, step.choices ?? []),
    step.dial && dial(lesson, step.dial),
    step.sketch && sketching(lesson),
  ];
}

/** Whether the answers are places in the picture. @param {service.CourseStep} step */
const points = (step) => step.answers?.some(({site}) => site) ?? false;

/** The place that was pointed at, or how to point. @param {Lesson} lesson */
function pointing({step, view}) {
  const answer = view.chosen === null ? undefined : step.answers?.[view.chosen];
  return h(
    'p',
    {class: 'predict', role: 'status'},
    answer ? t('page.lesson.pointed', {place: named(answer.text)}) : t('page.lesson.point'),
  );
}

/** How to draw, and the way to the strip. @param {Lesson} lesson */
function sketching(lesson) {
  return h(
    'div',
    {class: 'predict'},
    h('p', {}, lesson.view.sketch ? t('page.lesson.sketch.drawn') : t('page.lesson.sketch.how')),
    h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        'data-keep': 'sketch',
        disabled: lesson.view.phase !== 'before',
        onclick: () => lesson.pad.element.focus(),
      },
      t('page.lesson.sketch.start'),
    ),
    h('p', {class: 'soft keys'}, h('kbd', {}, '← →'), ' ', h('kbd', {}, '↑ ↓'), ' ', t('page.lesson.sketch.keys')),
  );
}

/**
 * The answers or choices, as a group of radio buttons.
 * @param {Lesson} lesson
 * @param {readonly {text: service.Words}[]} all
 */
const options = (lesson, all) =>
  h(
    'div',
    {class: 'options', role: 'radiogroup', 'aria-labelledby': 'lesson-ask'},
    all.map(({text}, place) =>
      h(
        'label',
        {class: 'option'},
        h('input', {
          type: 'radio',
          name: 'answer',
          'data-keep': `answer-${place}`,
          checked: lesson.view.chosen === place,
          disabled: lesson.view.phase === 'running',
          onchange: () => lesson.choose(place),
        }),
        h('span', {class: 'letter', 'aria-hidden': 'true'}, String.fromCharCode(65 + place)),
        h('span', {}, withSymbols(named(text))),
        voteBar(place),
        h('kbd', {}, place + 1),
      ),
    ),
  );

/** @param {Lesson} lesson @param {service.Dial} setting */
function dial(lesson, {text, low, high, unit}) {
  const {view} = lesson;
  const row = slider({
    name: named(text),
    scale: logarithmic(low, high),
    value: view.dial ?? low,
    low,
    high,
    positive: true,
    change: (value) => lesson.turn(value),
  });
  return h(
    'div',
    {class: 'dial'},
    h('b', {}, withSymbols(named(text))),
    row.range,
    row.field,
    h('span', {class: 'soft'}, unit ?? ''),
  );
}

/** @param {Lesson} lesson @returns {Child[]} */
function buttons(lesson) {
  const {step, view} = lesson;
  const last = view.place + 1 === view.plan.steps.length;
  const next = h(
    'button',
    {type: 'button', class: 'run', 'data-keep': 'act', onclick: () => lesson.next()},
    last ? t('page.lesson.finish') : t('page.lesson.next'),
  );
  if (view.phase === 'after')
    return [
      next,
      h('button', {type: 'button', class: 'quiet', onclick: () => lesson.again()}, t('page.lesson.try-again')),
    ];
  if (!step.run) return [next];
  const running = view.phase === 'running';
  return [
    h(
      'button',
      {
        type: 'button',
        class: 'run',
        'data-keep': 'act',
        'aria-disabled': String(view.phase !== 'before' || !lesson.ready()),
        onclick: () => lesson.run(),
      },
      running ? t('page.lesson.running') : step.run.text ? named(step.run.text) : t('page.lesson.run'),
    ),
    !running && !lesson.ready() ? h('span', {class: 'soft'}, first(step)) : h('kbd', {}, 'Enter'),
  ];
}

/** What has to be done before it runs. @param {service.CourseStep} step */
function first(step) {
  if (step.sketch) return t('page.lesson.sketch-first');
  return points(step) ? t('page.lesson.point-first') : t('page.lesson.answer-first');
}

/** @param {Lesson} lesson @returns {Child[]} */
function after(lesson) {
  const {step, view} = lesson;
  const {judged} = view;
  const values = judged?.values ?? {};
  const right = lesson.right();
  const options = step.answers?.length ? step.answers : (step.choices ?? []);
  const said = view.chosen === null ? undefined : options[view.chosen];
  const answer = view.chosen === null ? step.answers?.[judged?.right.indexOf(true) ?? -1] : undefined;
  const saw = typeof judged?.saw === 'number' ? step.saw?.[judged.saw] : undefined;
  return [
    h(
      'div',
      {class: `feedback${right ? ' right' : ''}`, role: 'status', tabindex: -1},
      mark(right),
      h(
        'div',
        {},
        h('p', {class: 'verdict'}, verdict(step, right)),
        said && h('p', {}, t('page.lesson.said', {answer: named(said.text)})),
        answer && h('p', {}, t('page.lesson.right-answer', {answer: named(answer.text)})),
        saw && h('p', {}, prose(named(saw.text), values)),
        view.sketch && h('p', {class: 'soft'}, t('page.lesson.sketched')),
      ),
    ),
    votesAfter(step, judged),
    h(
      'div',
      {class: 'why'},
      right === false && step.look && [h('h2', {}, t('page.lesson.look')), h('p', {}, prose(named(step.look), values))],
      (step.why?.length ?? 0) > 0 && h('h2', {}, t('page.lesson.why')),
      step.why?.map((words) => h('p', {}, prose(named(words), values))),
    ),
  ];
}

/** @param {service.CourseStep} step @param {boolean | null} right */
function verdict(step, right) {
  if (right === null) return t('page.lesson.seen');
  if (right) return t('page.lesson.right');
  return step.answers?.length ? t('page.lesson.wrong') : t('page.lesson.not-yet');
}

/** @param {boolean | null} right */
function mark(right) {
  const path = right === null ? 'M4.500 8h7' : right ? 'M4 8.500l2.800 2.800L12 5.500' : 'M5 5l6 6M11 5l-6 6';
  return h(
    'svg',
    {viewBox: '0 0 16 16', class: 'answer-mark', 'aria-hidden': 'true'},
    h('circle', {cx: 8, cy: 8, r: 7.2}),
    h('path', {d: path}),
  );
}
