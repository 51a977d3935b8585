// The wall in a round of hidden faults: what was answered, how fast, and the replay of one student.

import {fill, h, number} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';
import {alikeWords, answerWords, channelName, toldWords, truthWords} from './answer-words.js';
import {rightOrNot} from './votes-card.js';
import {outcomeView} from './record-pictures.js';

/** @import {Classroom} from './classroom.js' */
/** @import * as service from '../../types/service.js' */

/** What an answer counts as in the histogram. @param {service.ChallengeAnswer} answer */
const kindOf = ({verdict, channel}) => (verdict === 'channel' ? `channel ${channel}` : verdict);

/**
 * The histogram: right ones filled, others hollow.
 * @param {service.RoundView} round
 * @param {readonly service.Tile[]} all
 */
export function histogram(round, all) {
  if (!round.revealed)
    return h(
      'section',
      {class: 'card answers'},
      h('h2', {}, t('page.classroom.answers')),
      h(
        'p',
        {class: 'big-count', role: 'status'},
        t('page.classroom.voted', {n: all.filter((one) => one.answered).length, of: all.length}),
      ),
    );
  const kinds = [
    ...round.choices.map(({channel, title}) => ({kind: `channel ${channel}`, words: named(title)})),
    {kind: 'none', words: t('page.class.nothing')},
    {kind: 'cannot-be-told', words: t('page.class.cannot')},
  ].map(({kind, words}) => {
    const given = all.filter(({answer}) => answer && kindOf(answer) === kind);
    return {words, count: given.length, right: given.filter(({outcome}) => outcome?.right).length};
  });
  const most = Math.max(1, ...kinds.map(({count}) => count));
  const some = kinds.filter(({count}) => count > 0);
  return h(
    'section',
    {class: 'card answers'},
    h('div', {class: 'answers-head'}, h('h2', {}, t('page.classroom.answers')), rightOrNot()),
    some.length === 0 && h('p', {class: 'soft'}, t('page.classroom.no-answers')),
    h(
      'ol',
      {class: 'bars in-line'},
      some.map(({words, count, right}) =>
        h(
          'li',
          {},
          h('span', {}, words),
          h(
            'span',
            {class: 'bar-pair', role: 'img', 'aria-label': t('page.classroom.right-of', {n: right, of: count})},
            right > 0 && h('span', {class: 'bar right', style: `width: ${(100 * right) / most}%`}),
            count > right && h('span', {class: 'bar wrong', style: `width: ${(100 * (count - right)) / most}%`}),
          ),
          h('b', {class: 'count'}, count),
        ),
      ),
    ),
  );
}

/**
 * A dot for each answer over the seconds since its fault began.
 * @param {service.RoundView} round
 * @param {readonly service.Tile[]} all
 */
export function howFast(round, all) {
  if (!round.revealed) return null;
  const dots = all.flatMap(({outcome}) =>
    outcome && outcome.after !== null && outcome.after >= 0
      ? [{after: outcome.after, right: outcome.right === true}]
      : [],
  );
  const found = all.flatMap(({outcome}) =>
    outcome?.fault && outcome.detector && outcome.detector.verdict !== 'none'
      ? [outcome.detector.at - outcome.fault.onset]
      : [],
  );
  if (dots.length === 0) return null;
  const detector = median(found);
  const most = niceEnd(Math.max(...dots.map(({after}) => after), detector ?? 0));
  /** @param {number} seconds */
  const x = (seconds) => 12 + (Math.max(0, seconds) / most) * 276;
  const columns = new Map();
  const drawn = dots
    .sort((a, b) => a.after - b.after)
    .map(({after, right}) => {
      const place = Math.round(x(after) / 11);
      const level = columns.get(place) ?? 0;
      columns.set(place, level + 1);
      return h('circle', {cx: place * 11, cy: 104 - 11 * level, r: 4.6, class: right ? 'dot-right' : 'dot-wrong'});
    });
  const quick = dots.filter(({right}) => right).map(({after}) => after);
  const cannot = all.filter(({answer}) => answer?.verdict === 'cannot-be-told');
  return h(
    'section',
    {class: 'card answers'},
    h(
      'div',
      {class: 'answers-head'},
      h('h2', {}, t('page.classroom.how-fast')),
      h('span', {class: 'soft small'}, t('page.classroom.after-fault')),
    ),
    h(
      'svg',
      {viewBox: '0 0 300 132', class: 'dots', role: 'img', 'aria-label': t('page.classroom.how-fast')},
      h('line', {x1: 8, x2: 292, y1: 111, y2: 111, class: 'axis'}),
      [0, most / 2, most].map((at) =>
        h('text', {x: x(at), y: 127, 'text-anchor': at === most ? 'end' : 'middle'}, `${number(at, 3)} s`),
      ),
      detector !== null && [
        h('line', {x1: x(detector), x2: x(detector), y1: 22, y2: 111, class: 'detector'}),
        h('path', {d: `M${x(detector) - 5} 14h10l-5 8z`, class: 'detector-mark'}),
        h(
          'text',
          {x: Math.min(250, Math.max(40, x(detector))), y: 10, class: 'detector-name', 'text-anchor': 'middle'},
          t('page.class.detector'),
        ),
      ],
      drawn,
    ),
    h(
      'p',
      {class: 'soft'},
      quick.length > 0 && t('page.classroom.half', {n: quick.length, seconds: number(median(quick), 3)}),
      ' ',
      detector !== null && t('page.classroom.detector-needs', {seconds: number(detector, 3)}),
      ' ',
      cannot.length > 0 &&
        t('page.classroom.said-cannot', {n: cannot.length, right: cannot.filter(({outcome}) => outcome?.right).length}),
    ),
  );
}

/** @param {number[]} values */
function median(values) {
  if (values.length === 0) return null;
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor((sorted.length - 1) / 2)];
}

/** A round number at or above a value. @param {number} value */
function niceEnd(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-9)));
  return power * ([1, 2, 4, 5, 10].find((one) => one * power >= value) ?? 10);
}

/**
 * The replay of the tile that is open.
 * @param {Classroom} page
 * @param {service.RoundView} round
 * @param {service.Tile} tile
 */
export function replay(page, round, tile) {
  const name = page.nameOf(tile);
  const {outcome, answer} = tile;
  const end = round.horizon ?? 1;
  const words = {
    fault: outcome?.fault ? truthWords(round, outcome) : '',
    detector: t('page.class.detector'),
    student: name,
  };
  const view = outcomeView(outcome, answer, end, words);
  page.record.show({...view, marks: view.marks?.filter((mark) => mark.t <= page.record.now + 1e-9 || round.revealed)});
  return h(
    'section',
    {class: 'card replay', 'aria-label': t('page.classroom.replay', {name})},
    h(
      'div',
      {class: 'answers-head'},
      h('h2', {}, t('page.classroom.replay', {name})),
      outcome?.fault &&
        h(
          'span',
          {class: 'soft'},
          t('page.classroom.began', {name: truthWords(round, outcome), t: number(outcome.fault.onset, 4)}),
        ),
    ),
    outcome && h('p', {class: 'replay-said'}, `${said(round, outcome)} ${toldWords(round, outcome)}`),
    page.record.root,
    h(
      'div',
      {class: 'replay-foot'},
      h(
        'button',
        {class: 'quiet', type: 'button', 'data-keep': 'play', onclick: () => page.play()},
        page.playing ? t('page.classroom.stop') : t('page.classroom.play'),
      ),
      h('b', {class: 'num'}, `${number(page.record.now, 4)} s`),
      h('span', {class: 'soft'}, answer ? details(round, answer) : t('page.classroom.no-answer')),
      h('span', {class: 'grow'}),
      outcome?.fault &&
        h('span', {class: 'soft small legend'}, h('span', {class: 'key untold'}), t('page.classroom.untold')),
      h(
        'button',
        {class: 'quiet', type: 'button', 'data-keep': 'shut', onclick: () => page.show(null)},
        t('page.classroom.shut'),
      ),
    ),
  );
}

/** @param {service.RoundView} round @param {service.Outcome} outcome */
function said(round, {right, after}) {
  if (right === null) return '';
  if (!right) return t('page.classroom.was-wrong');
  return after === null ? t('page.classroom.was-right') : t('page.classroom.found-after', {seconds: number(after, 3)});
}

/** @param {service.RoundView} round @param {service.ChallengeAnswer} answer */
function details(round, answer) {
  if (answer.verdict === 'cannot-be-told') return `${answerWords(round, answer)}: ${alikeWords(round, answer.alike)}`;
  if (answer.verdict === 'none') return answerWords(round, answer);
  const unit = round.choices.find(({channel}) => channel === answer.channel)?.unit ?? '';
  return t('page.classroom.answer-details', {
    name: channelName(round, answer.channel),
    t: number(answer.onset, 4),
    size: `${number(answer.size, 3)} ${unit}`.trim(),
  });
}

/** What a tile says. @param {service.RoundView} round @param {service.Tile} tile */
export function tileWords(round, {answer, answered, asleep, outcome}) {
  if (answer)
    return [
      answerWords(round, answer),
      outcome?.after !== null && outcome?.fault ? `${number(outcome?.after, 3)} s` : '',
    ];
  if (asleep) return [t('page.classroom.asleep'), ''];
  if (round.revealed) return [t('page.classroom.no-answer'), ''];
  return [answered ? t('page.classroom.answered') : t('page.classroom.looking'), ''];
}

/** The choice of a plant and a time for the next round. @param {Classroom} page */
export function faultsForm(page) {
  const setup = h(
    'select',
    {id: 'setup', 'data-keep': 'setup', onchange: (event) => (page.setup = event.currentTarget.value)},
    page.setups.map(({id, title}) => h('option', {value: id, selected: id === page.setup}, named(title))),
  );
  const minutes = h(
    'select',
    {id: 'minutes', 'data-keep': 'minutes', onchange: (event) => (page.seconds = Number(event.currentTarget.value))},
    [60, 120, 240, 360, 600].map((seconds) =>
      h('option', {value: seconds, selected: seconds === page.seconds}, t('page.classroom.minutes', {n: seconds / 60})),
    ),
  );
  return h(
    'div',
    {class: 'faults-form'},
    h('label', {for: 'setup'}, t('page.classroom.plant')),
    setup,
    h('label', {for: 'minutes'}, t('page.classroom.time')),
    minutes,
    h(
      'button',
      {class: 'run', type: 'button', 'data-keep': 'own', onclick: () => page.begin('own')},
      t('page.classroom.own'),
    ),
  );
}
