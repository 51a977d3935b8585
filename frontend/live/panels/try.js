// Try this: questions about the experiment, each with a button that carries it out.

import {get} from '../../common/api.js';
import {childrenOf, fill, h} from '../../common/dom.js';
import {called} from '../../common/names.js';
import {withSymbols} from '../../widgets/prose.js';
import {wholeLines} from '../../widgets/whole-lines.js';
import {heading, seconds} from '../../widgets/controls.js';
import {icon} from '../../widgets/svg.js';
import {t} from '../../i18n/words.js';

/** @import {App, BatchCommand, Command, FaultInput, Language} from '../types.js' */
/** @import * as service from '../../types/service.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  /** @type {Map<string, Promise<service.LessonPlan>>} */
  const lessons = new Map();
  /** @type {service.LessonQuestion[]} */
  let shown = [];
  const list = h('ol', {class: 'try scroll', tabindex: 0});
  const more = wholeLines(list, () => childrenOf(list), app);
  const draw = async () => {
    const {experiment, language} = app.state;
    element.hidden = experiment === null;
    if (!experiment) return;
    /** @type {Promise<service.LessonPlan>} */
    const lesson = lessons.get(experiment) ?? get(`/api/lessons/${encodeURIComponent(experiment)}`);
    lessons.set(experiment, lesson);
    const {questions} = await lesson.catch(() => ({questions: []}));
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
      h('span', {}, withSymbols(words[language] ?? words.en)),
      commands.length > 0 &&
        h(
          'button',
          {
            type: 'button',
            class: 'plain go control-only',
            title: t('page.try.do'),
            'aria-label': t('page.try.do-question', {question: words[language] ?? words.en}),
            onclick: () => carryOut(commandsOf(commands)),
          },
          icon('go', 13),
        ),
      h('p', {class: 'coming', role: 'status'}),
    );
  /** @param {BatchCommand[]} commands */
  const carryOut = async (commands) => {
    try {
      await app.act.together(commands);
      if (!app.state.playing) app.act.play();
    } catch (error) {
      app.act.refused(error);
    }
  };
  /**
   * Show the fault that a question has injected for later. It is in the log, so that it is shown again after a rewind
   * or a reload.
   */
  const wait = () => {
    const {faults, log, plant, spec} = app.state;
    for (const [place, {do: commands}] of shown.entries()) {
      const later = commandsOf(commands).flatMap((one) =>
        one.type === 'inject' && one.fault.onset > 0 ? one.fault : [],
      );
      const coming =
        later.length === 0
          ? null
          : faults.findLast(
              ({id, subject, shape, active, ended}) =>
                !active &&
                !ended &&
                later.some((fault) => siteOf(fault) === subject && fault.shape === shape) &&
                log.some((event) => event.kind === 'inject' && event.fault === id),
            );
      const line = element.querySelectorAll('.coming')[place];
      if (line)
        line.textContent = coming
          ? t('page.try.waiting', {name: called(coming.subject, plant), t: seconds(coming.onset, spec?.horizon)})
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
 * The commands of a question; the service has checked them.
 * @param {service.LessonQuestion['do']} commands
 */
const commandsOf = (commands) => /** @type {BatchCommand[]} */ (/** @type {unknown} */ (commands));

/**
 * The channel or output that a fault acts on.
 * @param {FaultInput} fault
 */
const siteOf = (fault) => ('channel' in fault ? fault.channel : fault.output);
