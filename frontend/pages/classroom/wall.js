// The wall: the round, a tile for each student, and on the right the code, the answers and how fast they came.

import {fill, h} from '../../common/dom.js';
import {withSymbols} from '../../widgets/prose.js';
import {named, t} from '../../i18n/words.js';
import {clock} from './answer-words.js';
import {joinCard} from './join-card.js';
import {markOf} from './marks.js';
import {votesCard} from './votes-card.js';
import {faultsForm, histogram, howFast, replay, tileWords} from './wall-faults.js';

/** @import {Classroom} from './classroom.js' */
/** @import * as service from '../../types/service.js' */

/** @param {Classroom} page @param {service.RoomOpened} room @param {service.WallView} state */
export function drawWall(page, room, state) {
  const {round} = state;
  fill(
    page.main,
    h(
      'section',
      {class: 'wall-main'},
      head(page, state),
      page.problem && h('p', {class: 'alarm', role: 'alert'}, page.problem),
      state.grades && grades(state.grades),
      tiles(page, state),
      below(page, state),
    ),
    h(
      'aside',
      {class: 'wall-side', 'aria-label': t('page.classroom.side')},
      joinCard(room, state),
      round?.kind === 'own' ? [histogram(round, state.tiles), howFast(round, state.tiles)] : votesCard(page, state),
    ),
  );
}

/**
 * What is below the tiles: a replay, what to begin, what to show.
 * @param {Classroom} page
 * @param {service.WallView} state
 */
function below(page, {round, tiles: all}) {
  const open = round?.kind === 'own' ? all.find(({id}) => id === page.open) : undefined;
  return [
    round && open && page.record.head && replay(page, round, open),
    page.choosing || round === null ? beginning(page) : round.kind === 'follow' && following(page, round),
  ];
}

/** @param {service.RoundView | null} round */
function titles(round) {
  if (round === null) return [t('page.classroom.room-open'), t('page.classroom.not-begun')];
  if (round.kind === 'own') {
    const waiting = round.left === null ? t('page.classroom.preparing') : t('page.classroom.hidden');
    const under = round.revealed ? t('page.class.revealed') : waiting;
    return [t('page.classroom.round-own', {n: round.number}), `${named(round.title)} · ${under}`];
  }
  const {card} = round.lead ?? {};
  return [
    t('page.classroom.round-follow', {n: round.number}),
    card
      ? t('page.classroom.at-step', {title: named(card.title), n: card.place, of: card.of})
      : t('page.classroom.no-step'),
  ];
}

/** @param {Classroom} page @param {service.WallView} state */
function head(page, {round, tiles: all}) {
  const [title, under] = titles(round);
  const running = round?.kind === 'own' && !round.revealed;
  /** @param {string} keep @param {string} words @param {() => unknown} act @param {object} [more] */
  const button = (keep, words, act, more = {}) =>
    h('button', {class: 'quiet', type: 'button', 'data-keep': keep, onclick: act, ...more}, words);
  return h(
    'header',
    {class: 'wall-head'},
    h('div', {}, h('h1', {}, title), h('p', {class: 'soft'}, under)),
    h('span', {class: 'grow'}),
    running && round.left !== null && h('b', {class: 'wall-clock', title: t('page.class.left')}, clock(page.left)),
    page.lost &&
      h(
        'span',
        {class: 'connection lost', role: 'status'},
        h('span', {class: 'dot'}),
        t('page.header.connection-lost'),
      ),
    all.length > 0 &&
      button('names', page.names ? t('page.classroom.hide-names') : t('page.classroom.show-names'), () =>
        page.turnNames(),
      ),
    round && button('csv', t('page.classroom.csv'), () => page.results()),
    button('close', t('page.classroom.close'), () => confirm(t('page.classroom.close-sure')) && page.close()),
    running && button('next', t('page.classroom.reveal'), () => page.act('POST', '/room/reveal'), {class: 'run'}),
    round &&
      !running &&
      button('next', t('page.classroom.next-round'), () => page.choose(), {
        class: 'run',
        'aria-expanded': String(page.choosing),
      }),
  );
}

/** How many points have reached the gradebook of the learning platform. @param {service.GradesView} passed */
function grades({sent, waiting, failed, why}) {
  const words = [t('page.classroom.grades-sent', {n: sent})];
  if (waiting) words.push(t('page.classroom.grades-waiting', {n: waiting}));
  return h(
    'p',
    {class: 'soft', role: 'status'},
    words.join(' · '),
    failed > 0 && h('span', {class: 'alarm'}, ` · ${t('page.classroom.grades-failed', {n: failed, why})}`),
  );
}

/** @param {Classroom} page @param {service.WallView} state */
function tiles(page, state) {
  const size = state.tiles.length > 40 ? 'many' : state.tiles.length > 24 ? 'some' : 'few';
  if (state.tiles.length === 0) return h('p', {class: 'wall-empty soft'}, t('page.classroom.nobody'));
  return h(
    'ul',
    {class: `tiles ${size}`, 'aria-label': t('page.classroom.students')},
    state.tiles.map((tile) => tileOf(page, state.round, tile)),
  );
}

/** @param {Classroom} page @param {service.RoundView | null} round @param {service.Tile} tile */
function tileOf(page, round, tile) {
  const own = round?.kind === 'own' ? round : null;
  const name = page.nameOf(tile);
  const [words, after] = own ? tileWords(own, tile) : [voteWords(round, tile), ''];
  const open = own !== null && page.open === tile.id;
  const states = [tile.asleep && 'asleep', own?.revealed && !tile.answered && 'empty', open && 'open'];
  return h(
    'li',
    {class: ['tile', ...states].filter(Boolean).join(' ')},
    h(
      'div',
      {class: 'tile-head'},
      own
        ? h(
            'button',
            {
              class: 'tile-open',
              type: 'button',
              'data-keep': `tile-${tile.id}`,
              'aria-pressed': String(open),
              onclick: () => page.show(tile.id),
              onkeydown: (event) => arrows(event),
            },
            name,
          )
        : h('b', {}, name),
      tile.mark && markOf(tile.mark),
      h(
        'button',
        {
          class: 'tile-remove',
          type: 'button',
          'data-keep': `remove-${tile.id}`,
          'aria-label': t('page.classroom.remove', {name}),
          title: t('page.classroom.remove', {name}),
          onclick: () => page.act('DELETE', `/room/students/${tile.id}`),
        },
        '×',
      ),
    ),
    h('p', {class: 'tile-said'}, withSymbols(words)),
    after && h('p', {class: 'tile-after'}, after),
  );
}

/** What a tile says of a vote. @param {service.RoundView | null} round @param {service.Tile} tile */
function voteWords(round, {asleep, answered, choice}) {
  const options = round?.lead?.card?.options ?? [];
  if (choice !== null) return `${'ABCDEFGHI'[choice]} · ${named(options[choice])}`;
  if (asleep) return t('page.classroom.asleep');
  if (options.length === 0) return t('page.classroom.here');
  return answered ? t('page.classroom.answered') : t('page.classroom.looking');
}

/** Arrows move among the tiles. @param {KeyboardEvent} event */
function arrows(event) {
  if (!event.key.startsWith('Arrow')) return;
  event.preventDefault();
  const all = [.../** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll('.tile-open'))];
  const place = all.findIndex((one) => one === event.target);
  const left = all[place].getBoundingClientRect().left;
  const column = all.filter((one) => Math.abs(one.getBoundingClientRect().left - left) < 2);
  const row = column.indexOf(all[place]);
  const next = {
    ArrowLeft: all[place - 1],
    ArrowRight: all[place + 1],
    ArrowUp: column[row - 1],
    ArrowDown: column[row + 1],
  }[event.key];
  next?.focus();
}

/** What the class does next. @param {Classroom} page */
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
    h('p', {}, t('page.classroom.own-about')),
    faultsForm(page),
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
        lessonLink(`/?lesson=${encodeURIComponent(id)}`, `${number} ${named(title)}`, `lesson-${id}`),
      ),
      lessonLink('/', t('page.classroom.live'), 'live'),
    ),
  );

/** @param {string} href @param {string} words @param {string} keep */
const lessonLink = (href, words, keep) =>
  h('li', {}, h('a', {class: 'quiet', href, target: 'thetascope-lesson', 'data-keep': keep}, words));
