// How to join: the code, the address and the QR code, always in sight.

import {h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */

/** @param {service.RoomOpened} room @param {service.WallView} state */
export function joinCard(room, {tiles}) {
  const asleep = tiles.filter((tile) => tile.asleep).length;
  return h(
    'section',
    {class: 'card join-card'},
    h(
      'div',
      {},
      h('h2', {}, t('page.classroom.join')),
      h('p', {class: 'room-code'}, room.code),
      h('p', {class: 'soft room-address'}, room.address.replace(/^https?:\/\//, '').replace(`/${room.code}`, '')),
      h('p', {class: 'soft', role: 'status'}, t('page.classroom.present', {n: tiles.length - asleep, asleep})),
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
