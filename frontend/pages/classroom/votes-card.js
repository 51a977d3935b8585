// The votes for the answers of a step, once they are to be seen.

import {h} from '../../common/dom.js';
import {withSymbols} from '../../widgets/prose.js';
import {named, t} from '../../i18n/words.js';

/** @import {Classroom} from './classroom.js' */
/** @import * as service from '../../types/service.js' */

/** @param {Classroom} page @param {service.WallView} state */
export function votesCard(page, {round, votes, tiles}) {
  const {card, phase, right} = round?.lead ?? {};
  if (!card || card.options.length === 0) return null;
  const after = phase === 'after';
  const shown = after || page.votes;
  const voted = tiles.filter((tile) => tile.answered).length;
  return h(
    'section',
    {class: 'card answers'},
    h('div', {class: 'answers-head'}, h('h2', {}, t('page.classroom.answers')), after && rightOrNot()),
    card.ask && h('p', {}, withSymbols(named(card.ask))),
    h('p', {class: 'soft', role: 'status'}, t('page.classroom.voted', {n: voted, of: tiles.length})),
    shown
      ? h(
          'ol',
          {class: 'bars'},
          card.options.map((text, place) =>
            bar(named(text), place, votes, after ? (right?.[place] ? 'right' : 'wrong') : ''),
          ),
        )
      : h(
          'button',
          {
            class: 'quiet',
            type: 'button',
            'data-keep': 'votes',
            onclick: () => {
              page.votes = true;
              page.draw();
            },
          },
          t('page.classroom.show-votes'),
          h('kbd', {}, 'V'),
        ),
  );
}

/** @param {string} words @param {number} place @param {readonly number[]} votes @param {string} mark */
function bar(words, place, votes, mark) {
  const share = (100 * (votes[place] ?? 0)) / Math.max(1, ...votes);
  return h(
    'li',
    {},
    h('span', {}, h('b', {class: 'soft'}, 'ABCDEFGHI'[place] ?? ''), ' ', withSymbols(words)),
    h('span', {class: 'bar-line'}, h('span', {class: `bar ${mark}`, style: `width: ${share}%`})),
    h('b', {class: 'count'}, votes[place] ?? 0),
  );
}

/** The legend of filled and hollow bars. */
export const rightOrNot = () =>
  h(
    'p',
    {class: 'soft small legend'},
    h('span', {class: 'key right'}),
    t('page.classroom.right'),
    h('span', {class: 'key'}),
    t('page.classroom.wrong'),
  );
