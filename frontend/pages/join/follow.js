// Following the teacher: the words of the step, its curves, and a vote.

import {fill, h} from '../../common/dom.js';
import {prose, withSymbols} from '../../widgets/prose.js';
import {named, t} from '../../i18n/words.js';
import {markOf} from '../classroom/marks.js';

const SHORT = 150; // letters of a text that is not folded

/** @import {Phone} from './join.js' */
/** @import * as service from '../../types/service.js' */

/** @param {Phone} phone @param {service.SeatView} state @param {service.LeadView} lead */
export function drawFollow(phone, state, lead) {
  const {card} = lead;
  phone.picture.show({since: lead.since, until: lead.until});
  const asks = card !== null && card.options.length > 0;
  fill(
    phone.main,
    h(
      'p',
      {class: 'seat-eyebrow'},
      card ? t('page.join.showing-step', {n: card.place, of: card.of}) : t('page.join.showing'),
      ' · ',
      phone.called,
    ),
    card && h('h1', {}, named(card.title)),
    card && lead.phase !== 'after' && said(phone, card),
    lead.live && h('div', {class: 'card'}, phone.picture.root),
    asks && (lead.phase === 'after' ? outcome(state, lead, card) : options(phone, state, lead, card)),
    phone.problem && h('p', {class: 'seat-problem', role: 'alert'}, phone.problem),
  );
  fill(
    phone.foot,
    asks && lead.phase === 'before' && voteButton(phone, state, lead),
    asks && lead.phase === 'running' && h('p', {class: 'soft', role: 'status'}, t('page.join.running')),
    (!asks || lead.phase === 'after') && [
      h('p', {class: 'soft'}, t('page.join.next-step')),
      h(
        'button',
        {class: 'quiet second', type: 'button', onclick: () => rename(phone)},
        t('page.join.rename', {name: phone.called}),
      ),
    ],
  );
}

/**
 * What the step says; long texts, which the teacher shows anyway, are folded.
 * @param {Phone} phone @param {service.StepCard} card
 */
function said(phone, card) {
  const texts = card.say.map(named);
  const paragraphs = texts.map((text) => h('p', {}, prose(text)));
  const letters = texts.join('').replace(/[\u3400-\u9fff]/g, 'xxx').length;
  if (letters <= SHORT) return h('div', {class: 'seat-say'}, paragraphs);
  return h(
    'details',
    {class: 'seat-say', open: phone.unfolded, ontoggle: (event) => (phone.unfolded = event.currentTarget.open)},
    h('summary', {'data-keep': 'say'}, t('page.join.say')),
    paragraphs,
  );
}

/**
 * The choice on this device, else the vote that was sent.
 * @param {Phone} phone @param {service.SeatView} state @param {service.LeadView} lead
 */
const chosen = (phone, state, lead) => (phone.draft?.step === lead.step ? phone.draft.choice : state.vote);

/**
 * @param {Phone} phone @param {service.SeatView} state @param {service.LeadView} lead @param {service.StepCard} card
 */
const options = (phone, state, lead, card) =>
  h(
    'div',
    {class: 'seat-options', role: 'radiogroup', 'aria-labelledby': 'seat-ask'},
    h('p', {class: 'seat-ask', id: 'seat-ask'}, withSymbols(named(card.ask))),
    card.options.map((text, place) =>
      h(
        'label',
        {class: 'seat-option'},
        h('input', {
          type: 'radio',
          name: 'vote',
          'data-keep': `vote-${place}`,
          disabled: lead.phase !== 'before',
          checked: chosen(phone, state, lead) === place,
          onchange: () => phone.keep({step: lead.step, choice: place}),
        }),
        h('span', {}, withSymbols(named(text))),
      ),
    ),
  );

/** @param {Phone} phone @param {service.SeatView} state @param {service.LeadView} lead */
function voteButton(phone, state, lead) {
  const choice = chosen(phone, state, lead);
  const sent = state.vote !== null && state.vote === choice;
  return h(
    'button',
    {
      class: 'run',
      type: 'button',
      'data-keep': 'act',
      'aria-disabled': String(choice === null || sent || phone.busy),
      onclick: () => choice !== null && !sent && phone.ask('PUT', '/vote', {step: lead.step, choice}),
    },
    sent ? t('page.join.voted') : state.vote === null ? t('page.join.vote') : t('page.join.vote-again'),
  );
}

/** @param {service.SeatView} state @param {service.LeadView} lead @param {service.StepCard} card */
function outcome(state, lead, card) {
  const {vote} = state;
  const right = vote === null ? null : lead.right[vote];
  const best = card.options.filter((_, place) => lead.right[place]);
  return [
    right !== null &&
      right !== undefined &&
      h(
        'div',
        {class: right ? 'card seat-result right' : 'card seat-result', role: 'status'},
        markOf(right ? 'right' : 'wrong'),
        h(
          'div',
          {},
          h('b', {}, right ? t('page.join.right') : t('page.join.not-right')),
          h('p', {}, t('page.join.you-said', {answer: named(card.options[vote ?? 0])})),
        ),
      ),
    vote === null && h('p', {class: 'soft', role: 'status'}, t('page.join.no-vote')),
    best.length > 0 &&
      !right &&
      h('p', {}, t('page.join.it-was', {answer: best.map((text) => named(text)).join(' / ')})),
  ];
}

/** @param {Phone} phone */
function rename(phone) {
  phone.renaming = true;
  phone.draw();
}
