// Try this: questions about the experiment at hand, each with what carries it out.

import {get} from '../../common/api.js';
import {childrenOf, fill, h, hatted} from '../../common/dom.js';
import {called} from '../../common/names.js';
import {wholeLines} from '../../widgets/whole-lines.js';
import {heading, seconds} from '../../widgets/controls.js';
import {icon} from '../../widgets/svg.js';
import {t} from '../../i18n/words.js';

/** @import {App, Command, Language} from '../types.js' */
/** @import * as service from '../../types/service.js' */

const SYMBOL = /λmin|(?<![A-Za-z])([θφρλxyuKHLR]\u0302?)(\d*)(?![A-Za-z\u0302])/g;

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const lessons = new Map();
  let shown = [];
  const list = h('ol', {class: 'try scroll', tabindex: 0});
  const more = wholeLines(list, () => childrenOf(list), app);
  const draw = async () => {
    const {experiment, language} = app.state;
    element.hidden = experiment === null;
    if (!experiment) return;
    if (!lessons.has(experiment)) {
      lessons.set(
        experiment,
        get(`/api/lessons/${encodeURIComponent(experiment)}`).catch(() => ({questions: []})),
      );
    }
    const {questions} = await lessons.get(experiment);
    if (experiment !== app.state.experiment) return;
    element.hidden = questions.length === 0;
    shown = questions;
    list.setAttribute('aria-label', t('page.try.title'));
    fill(
      list,
      questions.map((step) => question(step, language)),
    );
    fill(element, heading(t('page.try.title')), list, more);
  };
  /** @param {service.LessonQuestion} entry @param {Language} language */
  const question = ({question: words, do: commands}, language) =>
    h(
      'li',
      {},
      h('span', {}, set(words[language] ?? words.en)),
      commands.length > 0 &&
        h(
          'button',
          {
            type: 'button',
            class: 'plain go control-only',
            title: t('page.try.do'),
            'aria-label': t('page.try.do-question', {question: words[language] ?? words.en}),
            onclick: () => carryOut(commands),
          },
          icon('go', 13),
        ),
      h('p', {class: 'coming', role: 'status'}),
    );
  /** @param {Command[]} commands */
  const carryOut = async (commands) => {
    try {
      await app.act.together(commands);
      if (!app.state.playing) app.act.play();
    } catch (error) {
      app.act.refused(error);
    }
  };
  /** What a question waits for: a fault that it has injected to begin later. It stands in the log, so it is there again after going back or loading. */
  const wait = () => {
    const {faults, log, plant, spec} = app.state;
    for (const [place, {do: commands}] of shown.entries()) {
      const later = commands.filter(({fault}) => fault?.onset > 0);
      const coming =
        later.length === 0
          ? null
          : faults.findLast(
              ({id, subject, shape, active, ended}) =>
                !active &&
                !ended &&
                later.some(({fault}) => (fault.channel ?? fault.output) === subject && fault.shape === shape) &&
                log.some((event) => event.kind === 'inject' && event.fault === id),
            );
      const line = element.querySelectorAll('.coming')[place];
      if (line)
        line.textContent = coming
          ? t('page.try.waiting', {name: called(coming.subject, plant), t: seconds(coming.onset, spec.horizon)})
          : '';
    }
  };
  app.subscribe(
    (state) => [state.experiment, state.language],
    () => draw().then(wait),
  );
  app.subscribe((state) => [state.faults, state.log.length], wait);
}

/**
 * Words with their symbols in italics.
 * @param {string} words
 */
function set(words) {
  const parts = [];
  let at = 0;
  for (const match of words.matchAll(SYMBOL)) {
    parts.push(words.slice(at, match.index));
    at = match.index + match[0].length;
    parts.push(
      match[0] === 'λmin'
        ? [h('i', {}, 'λ'), h('sub', {}, 'min')]
        : [match[1].length > 1 ? hatted(match[1][0]) : h('i', {}, match[1]), match[2] && h('sub', {}, match[2])],
    );
  }
  return [...parts, words.slice(at)];
}
