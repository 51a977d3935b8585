// A round of hidden faults on a phone: the record as it plays, an answer, and after the reveal what it was.

import {fill, h, number} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';
import {answerWords, toldWords, truthWords} from '../classroom/answer-words.js';
import {markOf} from '../classroom/marks.js';
import {outcomeView} from '../classroom/record-pictures.js';

/** @import {Phone} from './join.js' */
/** @import * as service from '../../types/service.js' */

/**
 * @typedef {object} Draft   an answer that is not sent yet
 * @property {number} round
 * @property {service.ChallengeAnswer['verdict'] | null} verdict
 * @property {string | null} channel
 * @property {string[]} alike
 * @property {number | null} onset
 * @property {number | null} size
 */

/** @param {Phone} phone @param {service.SeatView} state @param {service.RoundView} round */
export function drawFaults(phone, state, round) {
  if (round.revealed) return drawOutcome(phone, state, round);
  const draft = draftOf(phone, state, round);
  const cannot = draft.verdict === 'cannot-be-told';
  const waiting = round.left === null || phone.record.head === null || phone.record.empty;
  phone.record.show({marks: draft.onset === null || cannot ? [] : [{t: draft.onset, kind: 'ink'}]});
  fill(
    phone.main,
    h('h1', {class: 'unseen'}, t('page.join.round', {n: round.number})),
    waiting
      ? h('p', {class: 'soft', role: 'status'}, t('page.join.preparing'))
      : [
          h('div', {class: 'card'}, phone.record.root),
          cannot ? alike(phone, round, draft) : [which(phone, round, draft), sliders(phone, round, draft)],
        ],
    phone.problem && h('p', {class: 'seat-problem', role: 'alert'}, phone.problem),
  );
  fill(
    phone.foot,
    !waiting && sendButton(phone, state, draft),
    cannot &&
      h(
        'button',
        {
          class: 'quiet second',
          type: 'button',
          onclick: () => phone.keepAnswer({...draft, verdict: null, channel: null, alike: []}),
        },
        t('page.join.think'),
      ),
  );
}

/**
 * The answer on this device, else the one that was sent, else an empty one.
 * @param {Phone} phone @param {service.SeatView} state @param {service.RoundView} round
 * @returns {Draft}
 */
function draftOf(phone, {answer}, {number: of}) {
  if (phone.answer?.round === of) return phone.answer;
  if (answer) {
    const {verdict, channel, alike: names, onset, size} = answer;
    return {round: of, verdict, channel, alike: [...names], onset, size};
  }
  return {round: of, verdict: null, channel: null, alike: [], onset: null, size: null};
}

/** @param {Phone} phone @param {service.RoundView} round @param {Draft} draft */
const which = (phone, round, draft) =>
  h(
    'div',
    {class: 'seat-options two', role: 'radiogroup', 'aria-labelledby': 'which'},
    h('p', {class: 'seat-ask', id: 'which'}, t('page.join.which')),
    round.choices.map(({channel, title, low, high}) =>
      option(phone, named(title), draft.channel === channel, `channel-${channel}`, () =>
        phone.keepAnswer({
          ...draft,
          verdict: 'channel',
          channel,
          onset: draft.onset ?? Math.round(phone.record.now / 2),
          size: draft.channel === channel ? draft.size : (low + high) / 2 || high / 2,
        }),
      ),
    ),
    option(phone, t('page.class.nothing'), draft.verdict === 'none', 'none', () =>
      phone.keepAnswer({...draft, verdict: 'none', channel: null, onset: null, size: null}),
    ),
    option(phone, t('page.join.cannot'), false, 'cannot', () =>
      phone.keepAnswer({...draft, verdict: 'cannot-be-told', channel: null}),
    ),
  );

/**
 * @param {Phone} phone
 * @param {string} words
 * @param {boolean} checked
 * @param {string} keep
 * @param {() => void} choose
 */
const option = (phone, words, checked, keep, choose) =>
  h(
    'label',
    {class: 'seat-option'},
    h('input', {type: 'radio', name: 'which', 'data-keep': keep, checked, onchange: choose}),
    h('span', {}, words),
  );

/** @param {Phone} phone @param {service.RoundView} round @param {Draft} draft */
function sliders(phone, round, draft) {
  const choice = round.choices.find(({channel}) => channel === draft.channel);
  if (!choice) return null;
  const end = Math.max(phone.record.now, draft.onset ?? 0, 1e-9);
  /**
   * @param {string} id @param {string} words @param {number} low @param {number} high @param {number} value
   * @param {string} unit @param {(value: number) => Draft} change
   */
  const slider = (id, words, low, high, value, unit, change) => {
    const shown = h('output', {for: id}, `${number(value, 3)} ${unit}`);
    const range = h('input', {
      id,
      type: 'range',
      'data-keep': id,
      min: low,
      max: high,
      step: (high - low) / 200,
      oninput: () => {
        const next = change(Number(Number(range.value).toPrecision(4)));
        phone.keepAnswer(next, false);
        fill(shown, `${number(Number(range.value), 3)} ${unit}`);
        if (next.onset !== null) phone.record.show({marks: [{t: next.onset, kind: 'ink'}]});
      },
      onchange: () => phone.draw(),
    });
    range.value = String(value);
    return h('div', {class: 'seat-slider'}, h('label', {for: id}, words), shown, range);
  };
  const now = () => (phone.answer?.round === draft.round ? phone.answer : draft);
  return [
    slider('since', t('page.join.since'), 0, end, draft.onset ?? end / 2, 's', (onset) => ({...now(), onset})),
    slider(
      'size',
      t('page.join.much'),
      choice.low,
      choice.high,
      draft.size ?? choice.high / 2,
      choice.unit,
      (size) => ({
        ...now(),
        size,
      }),
    ),
  ];
}

/** @param {Phone} phone @param {service.RoundView} round @param {Draft} draft */
const alike = (phone, round, draft) => [
  h(
    'div',
    {class: 'card seat-result'},
    h('span', {class: 'seat-question', 'aria-hidden': 'true'}, '?'),
    h('div', {}, h('b', {}, t('page.join.say-cannot')), h('p', {}, t('page.join.cannot-about'))),
  ),
  h(
    'fieldset',
    {class: 'seat-options two'},
    h('legend', {class: 'seat-ask'}, t('page.join.alike')),
    round.choices.map(({channel, title}) =>
      h(
        'label',
        {class: 'seat-option'},
        h('input', {
          type: 'checkbox',
          'data-keep': `alike-${channel}`,
          checked: draft.alike.includes(channel),
          onchange: () =>
            phone.keepAnswer({
              ...draft,
              alike: draft.alike.includes(channel)
                ? draft.alike.filter((one) => one !== channel)
                : [...draft.alike, channel],
            }),
        }),
        h('span', {}, named(title)),
      ),
    ),
  ),
];

/** @param {Phone} phone @param {service.SeatView} state @param {Draft} draft */
function sendButton(phone, {answer}, draft) {
  const whole = draft.verdict !== null && (draft.verdict !== 'cannot-be-told' || draft.alike.length >= 2);
  /** @param {Draft | service.ChallengeAnswer} one */
  const text = ({verdict, channel, alike: names, onset, size}) =>
    JSON.stringify([verdict, channel, [...names].sort(), onset, size]);
  const sent = answer !== null && text(answer) === text(draft);
  return h(
    'button',
    {
      class: 'run',
      type: 'button',
      'data-keep': 'act',
      'aria-disabled': String(!whole || sent || phone.busy),
      onclick: () => whole && !sent && phone.ask('PUT', '/answer', draft),
    },
    sent ? t('page.join.sent') : answer ? t('page.join.send-again') : t('page.join.send'),
  );
}

/** @param {Phone} phone @param {service.SeatView} state @param {service.RoundView} round */
function drawOutcome(phone, {answer, outcome, rank, students}, round) {
  const end = round.horizon ?? 1;
  const words = {fault: '', detector: t('page.class.detector'), student: ''};
  phone.record.show(outcomeView(outcome, answer, end, words));
  const right = outcome?.right ?? false;
  fill(
    phone.main,
    outcome === null
      ? h('p', {class: 'soft', role: 'status'}, t('page.join.grading'))
      : h(
          'div',
          {class: right ? 'card seat-result right' : 'card seat-result', role: 'status'},
          outcome.right !== null && markOf(right ? 'right' : 'wrong'),
          h(
            'div',
            {},
            h(
              'b',
              {},
              outcome.right === null
                ? t('page.join.it-was', {answer: truthWords(round, outcome)})
                : right
                  ? t('page.join.right-name', {name: answer ? answerWords(round, answer) : ''})
                  : t('page.join.wrong-name', {name: truthWords(round, outcome)}),
            ),
            answer && !right && h('p', {}, t('page.join.you-said', {answer: answerWords(round, answer)})),
            right &&
              outcome.after !== null &&
              h(
                'p',
                {},
                t('page.join.named-after', {seconds: number(outcome.after, 3)}),
                rank !== null && ` ${t('page.join.rank', {n: rank, of: students})}`,
              ),
          ),
        ),
    h('div', {class: 'card'}, phone.record.root),
    outcome && table(outcome, answer),
    outcome && h('p', {class: 'soft'}, toldWords(round, outcome)),
  );
  fill(phone.foot, h('p', {class: 'soft'}, t('page.join.next-round')));
}

/** @param {service.Outcome} outcome @param {service.ChallengeAnswer | null} answer */
function table(outcome, answer) {
  const {detector, fault} = outcome;
  /** @param {number | null | undefined} value @param {string} [unit] */
  const cell = (value, unit = '') =>
    h('td', {}, value === null || value === undefined ? '–' : `${number(value, 3)}${unit}`);
  /** @param {service.ChallengeAnswer | null} one */
  const after = (one) => (fault && one ? one.at - fault.onset : null);
  return h(
    'div',
    {class: 'card'},
    h(
      'table',
      {class: 'seat-table'},
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          h('td', {}),
          h('th', {scope: 'col'}, t('page.join.you')),
          h('th', {scope: 'col'}, t('page.class.detector')),
        ),
      ),
      h(
        'tbody',
        {},
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, t('page.join.since-row')),
          cell(answer?.onset, ' s'),
          cell(detector?.onset, ' s'),
        ),
        h('tr', {}, h('th', {scope: 'row'}, t('page.join.size-row')), cell(answer?.size), cell(detector?.size)),
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, t('page.join.after-row')),
          cell(after(answer), ' s'),
          cell(after(detector), ' s'),
        ),
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, t('page.join.points')),
          cell(outcome.points),
          cell(outcome.detector_points),
        ),
      ),
    ),
  );
}
