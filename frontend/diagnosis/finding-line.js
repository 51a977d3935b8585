// Findings in words: the sentence, and one line each. `app` need be no more than {state: {plant, spec, faults, diagnosis}}.

import {h, number} from '../common/dom.js';
import {badges, called, capital, spoken, split, symbolic} from '../common/names.js';
import {badge, seconds, took} from '../widgets/controls.js';
import {amount, resolutionOf, small} from './fault-size.js';
import {withoutBlanks} from '../i18n/render.js';
import {sentences} from '../i18n/sentences.js';
import {named, t} from '../i18n/words.js';

/** The sentence in the page's language, with symbols for names. */
export function spell(said, {state}) {
  const nameOf = (subject) => called(subject, state.plant);
  const {alarm} = said;
  const channel = alarm && state.plant.channels.find((one) => one.name === alarm.subject);
  return withoutBlanks(
    sentences()[said.key]({
      ...said,
      name: said.subject && nameOf(said.subject),
      otherName: said.other && nameOf(said.other),
      names: said.subjects?.map(nameOf),
      took: typeof said.took === 'number' && took(said.took),
      note: said.note && spoken(said.note, state.plant),
      from: number(said.from, 3),
      at: typeof said.at === 'number' && seconds(said.at, state.spec.horizon),
      again: typeof said.again === 'number' && seconds(said.again, state.spec.horizon),
      ...(alarm && {
        kind: symbolic(alarm.subject) ? t(`page.fault.kind.${channel.kind}`) : null,
        size: amount(alarm, channel),
        since: seconds(alarm.onset, state.spec.horizon),
      }),
    }),
  );
}

/** One finding: the size with its interval, and the story in a line. */
export function line(one, app) {
  const {state} = app;
  const {alarm, verdict} = one;
  const {channels} = state.plant;
  const channel = channels.find(({name}) => name === one.subject);
  const short = badges(channels);
  const acting = new Set(
    state.faults.filter((fault) => fault.active && fault.onChannel === one.onChannel).map((fault) => fault.subject),
  );
  const chips = one.subjects.map((name, place) => [
    place > 0 && h('small', {}, t('page.diagnosis.or')),
    badge(short.get(name) ?? split(name), {square: !one.onChannel, lit: verdict !== 'past' && acting.has(name)}),
  ]);
  const shown =
    alarm?.size === null || alarm?.size === undefined
      ? verdict === 'unseen'
        ? ''
        : t('page.diagnosis.not-in-model')
      : amount(alarm, channel);
  const end = {
    found: () =>
      one.delay !== null
        ? [t('page.diagnosis.found-in'), ' ', h('b', {}, took(one.delay))]
        : one.again
          ? t('page.diagnosis.alarm-was-on')
          : null,
    blamed: () => h('span', {class: 'alarm'}, t('page.diagnosis.other-fault')),
    false: () => h('span', {class: 'alarm'}, t('page.diagnosis.no-fault')),
    over: () => t('page.diagnosis.ended'),
    unseen: () => t('page.diagnosis.not-found'),
    past: () => t('page.diagnosis.cleared'),
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
  const {state} = app;
  const {horizon} = state.spec;
  const title =
    subjects.length > 1
      ? t('page.diagnosis.if', {name: called(subjects[0], state.plant)})
      : onChannel
        ? named(channel?.title) || called(subjects[0], state.plant)
        : capital(called(subjects[0], state.plant));
  if (verdict === 'unseen')
    return [title, t('page.diagnosis.since', {t: seconds(fault.onset, horizon)}), reason(fault, state)];
  if (verdict === 'past') return [title, `${seconds(alarm.onset, horizon)} – ${seconds(alarm.over, horizon)}`];
  const [from, to] = [alarm.from, alarm.to].map((t) => seconds(t, horizon));
  return [
    title,
    from === to
      ? t('page.diagnosis.since', {t: from})
      : t('page.diagnosis.began', {from: from.replace(/\s?s$/u, ''), to}),
    !onChannel && t('page.diagnosis.suspect-sensor'),
  ];
}

/** Why a fault may stay unfound. */
function reason(fault, {diagnosis}) {
  const known = resolutionOf(fault.subject, diagnosis);
  if (!fault.onChannel || !known) return '';
  if (known.smallest === null) return t('page.diagnosis.not-identifiable');
  const {size} = fault.fault;
  return typeof size === 'number' && Math.abs(size) < known.smallest
    ? t('page.diagnosis.too-small', {size: small(known.smallest)})
    : '';
}
