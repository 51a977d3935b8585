// The recording: what was done in a session, and the stretch of it that a step shows.

import {fill, h} from '../../common/dom.js';
import {LEFT, playedStrips, RIGHT} from '../../widgets/played-strips.js';
import {byName, choice, numeral} from './inputs.js';
import {t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */
/** @import {DraftLesson, DraftStep} from './draft.js' */

const WIDE = 320; // px of the recording's strip

/** @typedef {{t: number, words: string}} Happening */

/**
 * What was done in a recording, in its order.
 * @param {service.ExperimentInput | undefined} spec
 * @returns {Happening[]}
 */
export function happenings(spec) {
  /** @type {Happening[]} */
  const all = [{t: 0, words: t('page.editor.event.start')}];
  for (const fault of spec?.faults ?? []) {
    const name = 'channel' in fault ? fault.channel : fault.output;
    all.push({t: fault.onset ?? 0, words: t('page.editor.event.fault', {name})});
    if (fault.end !== null && fault.end !== undefined)
      all.push({t: fault.end, words: t('page.editor.event.end', {name})});
  }
  for (const command of spec?.commands ?? [])
    all.push({t: command.at, words: t('page.editor.event.command', {what: said(command)})});
  return all.sort((a, b) => a.t - b.t).slice(0, 40);
}

/** What a command concerns. @param {NonNullable<service.ExperimentInput['commands']>[number]} command */
function said(command) {
  switch (command.command) {
    case 'set-gain':
      return `${command.observer} ${command.gain} ${command.value}`;
    case 'set-signal':
      return command.name;
    case 'set-noise':
      return command.output;
    case 'add-observer':
      return command.observer.label;
    case 'remove-observer':
      return command.label;
    default:
      return command.command;
  }
}

/**
 * Draw the recording of a step: its strip with the stretch, what was done, the times of the stretch.
 * @param {HTMLElement} root
 * @param {object} options
 * @param {DraftLesson} options.lesson
 * @param {DraftStep | undefined} options.step
 * @param {service.Played | null} options.whole     the whole recording
 * @param {() => void} options.changed
 * @param {() => void} options.rebuild
 */
export function drawRecording(root, {lesson, step, whole, changed, rebuild}) {
  const names = Object.keys(lesson.experiments);
  const head = h(
    'div',
    {class: 'heading'},
    h('h2', {}, t('page.editor.record')),
    h('a', {class: 'press', href: '/'}, t('page.editor.record-live')),
  );
  if (!step || !names.length) return fill(root, head, h('p', {class: 'soft'}, t('page.editor.nothing-recorded')));
  const start = (step.start ??= {experiment: names[0], t: 0});
  const run = (step.run ??= {seconds: 10});
  const from = start.t ?? 0;
  const until = from + run.seconds;
  /** @param {number} a @param {number} b */
  const set = (a, b) => {
    const [first, last] = [Math.max(0, Math.min(a, b)), Math.max(a, b)];
    start.t = Number(first.toPrecision(6));
    run.seconds = Number(Math.max(0.1, last - first).toPrecision(6));
    changed();
  };
  const strip =
    whole && playedStrips(whole, {show: {strips: whole.curves.slice(0, 1).map((one) => one.strip)}}, {width: WIDE});
  return fill(
    root,
    head,
    h('p', {class: 'soft'}, t('page.editor.record.hint')),
    names.length > 1 &&
      choice(t('page.editor.recording'), byName(names), start.experiment, (value) => {
        start.experiment = value;
        changed();
        rebuild();
      }),
    whole && strip && stretchOn(strip, whole, from, until, set, rebuild),
    h(
      'div',
      {class: 'stretch'},
      h(
        'label',
        {},
        t('page.editor.from'),
        ' ',
        numeral(t('page.editor.from'), from, (value) => value !== null && set(value, (start.t ?? 0) + run.seconds)),
      ),
      h(
        'label',
        {},
        t('page.editor.until'),
        ' ',
        numeral(t('page.editor.until'), until, (value) => value !== null && set(start.t ?? 0, value)),
        ' s',
      ),
    ),
    h(
      'ol',
      {class: 'happenings'},
      happenings(lesson.experiments[start.experiment]).map((one) =>
        h(
          'li',
          {class: one.t >= from && one.t <= until ? 'within' : null},
          h('span', {class: 'num'}, `${Number(one.t.toPrecision(4))} s`),
          h('span', {}, one.words),
          h(
            'button',
            {
              type: 'button',
              class: 'quiet',
              'aria-label': t('page.editor.begin-here', {t: Number(one.t.toPrecision(4))}),
              title: t('page.editor.begin-here', {t: Number(one.t.toPrecision(4))}),
              onclick: () => {
                set(one.t, Math.max(one.t + 1, until));
                rebuild();
              },
            },
            '⇤',
          ),
        ),
      ),
    ),
  );
}

/**
 * The stretch on the strip; dragging chooses another one.
 * @param {HTMLElement} strip
 * @param {service.Played} whole
 * @param {number} from
 * @param {number} until
 * @param {(a: number, b: number) => void} set
 * @param {() => void} rebuild
 */
function stretchOn(strip, whole, from, until, set, rebuild) {
  const last = whole.t[whole.t.length - 1] ?? 1;
  const [left, wide] = [LEFT / WIDE, (WIDE - LEFT - RIGHT) / WIDE]; // of the picture's width: the plot
  const mark = h('div', {class: 'stretch-mark', 'aria-hidden': 'true'});
  /** @param {number} a @param {number} b */
  const place = (a, b) => {
    mark.style.left = `${100 * (left + (wide * Math.min(a, last)) / last)}%`;
    mark.style.width = `${(100 * wide * Math.max(0, Math.min(b, last) - Math.min(a, last))) / last}%`;
  };
  place(from, until);
  const box = h('div', {class: 'stretch-strip'}, strip, mark);
  /** @type {number | null} */
  let begun = null;
  /** @param {PointerEvent} event */
  const at = (event) => {
    const {left: edge, width} = box.getBoundingClientRect();
    return Math.min(last, Math.max(0, (((event.clientX - edge) / width - left) / wide) * last));
  };
  box.addEventListener('pointerdown', (event) => {
    begun = at(event);
    box.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  box.addEventListener(
    'pointermove',
    (event) => begun !== null && place(Math.min(begun, at(event)), Math.max(begun, at(event))),
  );
  box.addEventListener('pointerup', (event) => {
    if (begun !== null && Math.abs(at(event) - begun) > last / 100) set(begun, at(event));
    begun = null;
    rebuild();
  });
  return box;
}
