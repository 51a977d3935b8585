// Findings in words: the sentence, and one line each. `app` need be no more than {state: {plant, spec, faults, diagnosis}, text}.

import {h, number} from '../common/dom.js';
import {badges, called, spoken, split, symbolic} from '../common/names.js';
import {badge, seconds, took} from '../widgets/controls.js';
import {amount, resolutionOf, small} from './fault-size.js';

/** The sentence in the page's language, with symbols for names. */
export function spell(said, {state, text}) {
  const nameOf = (subject) => called(subject, state.plant, text);
  const {alarm} = said;
  const channel = alarm && state.plant.channels.find((one) => one.name === alarm.subject);
  return text.tight(
    text.sentences[said.key]({
      ...said,
      name: said.subject && nameOf(said.subject),
      otherName: said.other && nameOf(said.other),
      names: said.subjects?.map(nameOf),
      took: typeof said.took === 'number' && took(said.took),
      note: said.note && spoken(text.said(said.note), state.plant, text),
      from: number(said.from, 3),
      at: typeof said.at === 'number' && seconds(said.at, state.spec.horizon),
      again: typeof said.again === 'number' && seconds(said.again, state.spec.horizon),
      ...(alarm && {
        kind: symbolic(alarm.subject) ? text.kinds[channel.kind] : null,
        size: amount(alarm, channel),
        since: seconds(alarm.onset, state.spec.horizon),
      }),
    }),
  );
}

/** One finding: the size with its interval, and the story in a line. */
export function line(one, app) {
  const {state, text} = app;
  const {alarm, verdict} = one;
  const {channels} = state.plant;
  const channel = channels.find(({name}) => name === one.subject);
  const short = badges(channels);
  const acting = new Set(
    state.faults.filter((fault) => fault.active && fault.onChannel === one.onChannel).map((fault) => fault.subject),
  );
  const chips = one.subjects.map((name, place) => [
    place > 0 && h('small', {}, text.or),
    badge(short.get(name) ?? split(name), {square: !one.onChannel, lit: verdict !== 'past' && acting.has(name)}),
  ]);
  const shown =
    alarm?.size === null || alarm?.size === undefined
      ? verdict === 'unseen'
        ? ''
        : text.unknownSize
      : amount(alarm, channel);
  const end = {
    found: () =>
      one.delay !== null
        ? [text.foundIn, ' ', h('b', {}, took(one.delay))]
        : one.again
          ? text.alarmWasOn.toLowerCase()
          : null,
    blamed: () => h('span', {class: 'alarm'}, text.faultElsewhere),
    false: () => h('span', {class: 'alarm'}, text.noFaultActs),
    over: () => text.isOver,
    unseen: () => text.notFound,
    past: () => text.cleared,
  }[verdict]();
  return h(
    'div',
    {class: `finding ${verdict}${one.subjects.length > 1 ? ' either' : ''}`},
    h('span', {class: 'chips'}, chips),
    h(
      'div',
      {},
      h(
        'div',
        {class: 'line'},
        h(
          'span',
          {class: 'amount'},
          h('span', {class: 'value'}, shown),
          h('small', {}, alarm?.explained && channel?.unit),
        ),
        end && h('span', {class: 'sub'}, end),
      ),
      h('div', {class: 'sub'}, story(one, channel, app).filter(Boolean).join(' · ')),
    ),
  );
}

function story({verdict, subjects, onChannel, alarm, fault}, channel, app) {
  const {state, text} = app;
  const {horizon} = state.spec;
  const title =
    subjects.length > 1
      ? text.ifIt(called(subjects[0], state.plant, text))
      : onChannel
        ? text.named(channel?.title) || called(subjects[0], state.plant, text)
        : text.measurementOf(called(subjects[0], state.plant, text));
  if (verdict === 'unseen') return [title, text.since(seconds(fault.onset, horizon)), reason(fault, state, text)];
  if (verdict === 'past') return [title, `${seconds(alarm.onset, horizon)} – ${seconds(alarm.over, horizon)}`];
  const [from, to] = [alarm.from, alarm.to].map((t) => seconds(t, horizon));
  return [
    title,
    from === to ? text.since(from) : text.began(from.replace(/\s?s$/u, ''), to),
    !onChannel && text.suspects,
  ];
}

/** Why a fault may stay unfound. */
function reason(fault, {diagnosis}, text) {
  const known = resolutionOf(fault.subject, diagnosis);
  if (!fault.onChannel || !known) return '';
  if (known.smallest === null) return text.notSeenNow;
  const {size} = fault.fault;
  return typeof size === 'number' && Math.abs(size) < known.smallest ? text.tooSmall(small(known.smallest)) : '';
}
