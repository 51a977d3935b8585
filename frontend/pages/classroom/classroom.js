// The teacher's page of a classroom: open a room, and its wall.

import {connection, get, Problem, request} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {asSentence, refusalWords, speak, t} from '../../i18n/words.js';
import {keepRoom, teacherRoom} from './kept.js';
import {RoomSocket} from './room-socket.js';
import {drawWall} from './wall.js';

/** @import * as service from '../../types/service.js' */

export class Classroom {
  constructor() {
    this.main = query('#main');
    /** @type {service.RoomOpened | null} */
    this.room = null;
    /** @type {service.WallView | null} */
    this.state = null;
    /** @type {service.CourseLine[]} */
    this.lessons = [];
    this.lost = false;
    this.names = true;
    this.votes = false;
    this.problem = '';
    /** @type {RoomSocket | null} */
    this.socket = null;
  }

  async start() {
    this.lessons = /** @type {service.CourseList} */ (await get('/api/course')).lessons;
    const kept = teacherRoom();
    if (kept) await this.enter(() => this.ask('GET', '/room', undefined, kept.token));
    this.draw();
  }

  open() {
    return this.enter(() => this.ask('POST', '', {}));
  }

  /** @param {() => Promise<service.RoomOpened>} room */
  async enter(room) {
    this.problem = '';
    try {
      this.room = await room();
      const {token, code} = this.room;
      keepRoom({token, code});
      this.socket = new RoomSocket({
        path: '/api/classroom/room/stream',
        token,
        onMessage: (data) => {
          if (typeof data !== 'string') return;
          this.state = JSON.parse(data);
          this.draw();
        },
        onConnection: (now) => {
          this.lost = now === 'lost';
          if (now === 'gone') this.ended();
          this.draw();
        },
      });
    } catch (error) {
      if (error instanceof Problem && error.status === 404) keepRoom(null);
      else this.refused(error);
    }
    this.draw();
  }

  /**
   * @template T
   * @param {string} method @param {string} path @param {unknown} [body] @param {string} [token]
   * @returns {Promise<T>}
   */
  ask(method, path, body, token = this.room?.token ?? '') {
    return request(method, `/api/classroom${path}`, {body, headers: {'X-Teacher-Token': token}});
  }

  /** @param {string} method @param {string} path @param {unknown} [body] */
  async act(method, path, body) {
    this.problem = '';
    try {
      await this.ask(method, path, body);
    } catch (error) {
      this.refused(error);
    }
    this.draw();
  }

  /** @param {unknown} error */
  refused(error) {
    const {problem, remedy} = refusalWords(error);
    this.problem = [problem, remedy].map(asSentence).filter(Boolean).join(' ');
  }

  /** @param {'follow'} kind */
  begin(kind) {
    this.votes = false;
    return this.act('POST', '/room/rounds', {kind});
  }

  async close() {
    await this.act('DELETE', '/room');
    this.ended();
    this.draw();
  }

  ended() {
    this.socket?.stop();
    this.socket = this.room = this.state = null;
    keepRoom(null);
  }

  async results() {
    const answer = await fetch('/api/classroom/room/results', {headers: {'X-Teacher-Token': this.room?.token ?? ''}});
    const link = h('a', {
      href: URL.createObjectURL(await answer.blob()),
      download: `room-${this.room?.code ?? ''}.csv`,
    });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }

  draw() {
    document.title = `${this.room ? t('page.classroom.room', {code: this.room.code}) : t('page.classroom.title')} · Thetascope`;
    fill(query('.skip'), t('page.classroom.skip'));
    document.documentElement.classList.toggle('wall-page', this.room !== null);
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.keep : undefined;
    if (this.room && this.state) drawWall(this, this.room, this.state);
    else drawOpening(this);
    if (focused) /** @type {HTMLElement | null} */ (this.main.querySelector(`[data-keep="${focused}"]`))?.focus();
  }
}

/** @param {Classroom} page */
function drawOpening(page) {
  fill(
    page.main,
    h(
      'section',
      {class: 'card opening'},
      h('h1', {}, t('page.classroom.title')),
      h('p', {class: 'lead'}, t('page.classroom.lead')),
      h('ul', {}, [
        h('li', {}, t('page.classroom.about-join')),
        h('li', {}, t('page.classroom.about-follow')),
        h('li', {}, t('page.classroom.about-kept')),
      ]),
      page.problem && h('p', {class: 'alarm', role: 'alert'}, page.problem),
      h(
        'button',
        {class: 'run', type: 'button', 'data-keep': 'open', onclick: () => page.open()},
        t('page.classroom.open'),
      ),
    ),
  );
}

await speak(chosenLanguage());
const page = new Classroom();
mountTop(query('header'), connection, 'learn', () => page.draw());
await page.start();
addEventListener('keydown', (event) => {
  const typing = event.target instanceof Element && event.target.closest('input, select, textarea');
  if (typing || event.ctrlKey || event.metaKey || event.altKey || event.key.toUpperCase() !== 'V') return;
  page.votes = !page.votes;
  page.draw();
});
