// The wall: the round, a tile for each student, and on the right the code, the answers and how fast they came.

import {fill, h} from '../../common/dom.js';
import {withSymbols} from '../../widgets/prose.js';
import {named, t} from '../../i18n/words.js';
import {markOf} from './marks.js';

/** @import {Classroom} from './classroom.js' */
/** @import * as service from '../../types/service.js' */

/** @param {Classroom} page @param {service.RoomOpened} room @param {service.WallView} state */
export function drawWall(page, room, state) {
  fill(
    page.main,
    h(
      'section',
      {class: 'wall-main'},
      head(page, state),
      page.problem && h('p', {class: 'alarm', role: 'alert'}, page.problem),
      tiles(page, state),
      state.round === null ? beginning(page) : following(page, state.round),
    ),
    h(
      'aside',
      {class: 'wall-side', 'aria-label': t('page.classroom.side')},
      joinCard(page, room, state),
      answers(page, state),
    ),
  );
}

/** @param {Classroom} page @param {service.WallView} state */
function head(page, {round, tiles: all}) {
  const {card} = round?.lead ?? {};
  const under = round
    ? card
      ? t('page.classroom.at-step', {title: named(card.title), n: card.place, of: card.of})
      : t('page.classroom.no-step')
    : t('page.classroom.not-begun');
  return h(
    'header',
    {class: 'wall-head'},
    h(
      'div',
      {},
      h('h1', {}, round ? t('page.classroom.round-follow', {n: round.number}) : t('page.classroom.room-open')),
      h('p', {class: 'soft'}, under),
    ),
    h('span', {class: 'grow'}),
    page.lost &&
      h(
        'span',
        {class: 'connection lost', role: 'status'},
        h('span', {class: 'dot'}),
        t('page.header.connection-lost'),
      ),
    all.length > 0 &&
      h(
        'button',
        {
          class: 'quiet',
          type: 'button',
          'data-keep': 'names',
          'aria-pressed': String(!page.names),
          onclick: () => {
            page.names = !page.names;
            page.draw();
          },
        },
        page.names ? t('page.classroom.hide-names') : t('page.classroom.show-names'),
      ),
    round &&
      h(
        'button',
        {class: 'quiet', type: 'button', 'data-keep': 'csv', onclick: () => page.results()},
        t('page.classroom.csv'),
      ),
    h(
      'button',
      {
        class: 'quiet',
        type: 'button',
        'data-keep': 'close',
        onclick: () => confirm(t('page.classroom.close-sure')) && page.close(),
      },
      t('page.classroom.close'),
    ),
  );
}

/** @param {Classroom} page @param {service.WallView} state */
function tiles(page, state) {
  const size = state.tiles.length > 40 ? 'many' : state.tiles.length > 24 ? 'some' : 'few';
  if (state.tiles.length === 0) return h('p', {class: 'wall-empty soft'}, t('page.classroom.nobody'));
  return h(
    'ul',
    {class: `tiles ${size}`, 'aria-label': t('page.classroom.students')},
    state.tiles.map((tile, place) => tileOf(page, state, tile, place)),
  );
}

/** @param {Classroom} page @param {service.WallView} state @param {service.Tile} tile @param {number} place */
function tileOf(page, {round}, tile, place) {
  const options = round?.lead?.card?.options ?? [];
  const said = tile.choice === null ? '' : `${letter(tile.choice)} · ${named(options[tile.choice])}`;
  const words = tile.asleep
    ? t('page.classroom.asleep')
    : said ||
      (round === null || options.length === 0
        ? t('page.classroom.here')
        : tile.answered
          ? t('page.classroom.answered')
          : t('page.classroom.looking'));
  return h(
    'li',
    {class: `tile${tile.asleep ? ' asleep' : ''}${tile.answered ? ' answered' : ''}`},
    h(
      'div',
      {class: 'tile-head'},
      h('b', {}, page.names ? (tile.name ?? named(tile.animal)) : t('page.classroom.nameless', {n: place + 1})),
      tile.mark && markOf(tile.mark),
      h(
        'button',
        {
          class: 'tile-remove',
          type: 'button',
          'data-keep': `remove-${tile.id}`,
          'aria-label': t('page.classroom.remove', {name: tile.name ?? named(tile.animal)}),
          title: t('page.classroom.remove', {name: tile.name ?? named(tile.animal)}),
          onclick: () => page.act('DELETE', `/room/students/${tile.id}`),
        },
        '×',
      ),
    ),
    h('p', {class: 'tile-said'}, withSymbols(words)),
  );
}

/** @param {number} place */
const letter = (place) => 'ABCDEFGHI'[place] ?? '';

/** What to do first. @param {Classroom} page */
const beginning = (page) =>
  h(
    'section',
    {class: 'card round-choice'},
    h('h2', {}, t('page.classroom.begin')),
    h('p', {}, t('page.classroom.follow-about')),
    h(
      'button',
      {class: 'run', type: 'button', 'data-keep': 'follow', onclick: () => page.begin('follow')},
      t('page.classroom.follow'),
    ),
  );

/** The lessons, to be shown from another tab. @param {Classroom} page @param {service.RoundView} round */
const following = (page, round) =>
  h(
    'section',
    {class: 'card round-choice'},
    h('h2', {}, t('page.classroom.show')),
    h('p', {}, round.lead?.live ? t('page.classroom.showing') : t('page.classroom.show-about')),
    h(
      'ul',
      {class: 'lesson-links'},
      page.lessons.map(({id, number, title}) =>
        h(
          'li',
          {},
          h(
            'a',
            {
              class: 'quiet',
              href: `/?lesson=${encodeURIComponent(id)}`,
              target: 'thetascope-lesson',
              'data-keep': `lesson-${id}`,
            },
            `${number} ${named(title)}`,
          ),
        ),
      ),
      h('li', {}, h('a', {class: 'quiet', href: '/', target: 'thetascope-lesson'}, t('page.classroom.live'))),
    ),
  );

/** @param {Classroom} page @param {service.RoomOpened} room @param {service.WallView} state */
function joinCard(page, room, {tiles: all}) {
  const asleep = all.filter((tile) => tile.asleep).length;
  return h(
    'section',
    {class: 'card join-card'},
    h(
      'div',
      {},
      h('h2', {}, t('page.classroom.join')),
      h('p', {class: 'room-code', 'aria-label': [...room.code].join(' ')}, room.code),
      h('p', {class: 'soft room-address'}, room.address.replace(/^https?:\/\//, '').replace(`/${room.code}`, '')),
      h('p', {class: 'soft', role: 'status'}, t('page.classroom.present', {n: all.length - asleep, asleep})),
    ),
    qr(room),
    !room.reachable && h('p', {class: 'alarm small'}, t('page.classroom.unreachable')),
  );
}

/** The QR code: dark on white in both themes. @param {service.RoomOpened} room */
function qr({qr: rows, address}) {
  const size = rows.length + 4;
  const path = rows
    .flatMap((row, y) => [...row].map((dark, x) => (dark === '1' ? `M${x + 2} ${y + 2}h1v1h-1z` : '')))
    .join('');
  return h(
    'svg',
    {
      viewBox: `0 0 ${size} ${size}`,
      class: 'qr',
      role: 'img',
      'aria-label': t('page.classroom.qr', {address}),
      'shape-rendering': 'crispEdges',
    },
    h('rect', {width: size, height: size, fill: '#fff'}),
    h('path', {d: path, fill: '#000'}),
  );
}

/** The votes, once they are to be seen. @param {Classroom} page @param {service.WallView} state */
function answers(page, {round, votes, tiles: all}) {
  const card = round?.lead?.card;
  if (!card || card.options.length === 0) return null;
  const after = round?.lead?.phase === 'after';
  const shown = after || page.votes;
  const voted = all.filter((tile) => tile.answered).length;
  const most = Math.max(1, ...votes);
  return h(
    'section',
    {class: 'card answers'},
    h(
      'div',
      {class: 'answers-head'},
      h('h2', {}, t('page.classroom.answers')),
      after &&
        h(
          'p',
          {class: 'soft small legend'},
          h('span', {class: 'key right'}),
          t('page.classroom.right'),
          h('span', {class: 'key'}),
          t('page.classroom.wrong'),
        ),
    ),
    card.ask && h('p', {}, withSymbols(named(card.ask))),
    h('p', {class: 'soft', role: 'status'}, t('page.classroom.voted', {n: voted, of: all.length})),
    shown
      ? h(
          'ol',
          {class: 'bars'},
          card.options.map((text, place) => {
            const right = after && round?.lead?.right[place];
            return h(
              'li',
              {},
              h('span', {}, h('b', {class: 'soft'}, letter(place)), ' ', withSymbols(named(text))),
              h(
                'span',
                {class: 'bar-line'},
                h('span', {
                  class: `bar${right ? ' right' : after ? ' wrong' : ''}`,
                  style: `width: ${(100 * (votes[place] ?? 0)) / most}%`,
                }),
              ),
              h('b', {class: 'count'}, votes[place] ?? 0),
            );
          }),
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
