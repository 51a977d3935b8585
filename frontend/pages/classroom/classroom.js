// The teacher's page of a classroom: open a room, and its wall.

import {connection, get, Problem, request} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {asSentence, named, refusalWords, speak, t} from '../../i18n/words.js';
import {keepRoom, launchSecret, teacherRoom} from './kept.js';
import {RoomSocket} from './room-socket.js';
import {clock} from './answer-words.js';
import {RecordPictures} from './record-pictures.js';
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
    /** @type {readonly service.ClassSetup[]} */
    this.setups = [];
    this.setup = '';
    this.seconds = 240;
    this.choosing = false;
    /** the student whose record is open @type {string | null} */
    this.open = null;
    this.record = new RecordPictures();
    /** @type {service.Replay | null} */
    this.replay = null;
    this.playing = false;
    this.until = 0; // when the answers are revealed, on the clock of this page
    setInterval(() => this.tick(), 500);
    this.lost = false;
    this.names = true;
    this.votes = false;
    this.problem = '';
    /** @type {RoomSocket | null} */
    this.socket = null;
  }

  async start() {
    this.lessons = /** @type {service.CourseList} */ (await get('/api/course')).lessons;
    this.setups = /** @type {service.ClassSetups} */ (await get('/api/classroom/setups')).setups;
    this.setup = this.setups[0]?.id ?? '';
    const kept = teacherRoom();
    const launch = launchSecret();
    if (launch) {
      await this.enter(() => this.ask('POST', '/lti/room', {launch}, ''));
      history.replaceState(null, '', '/classroom/');
    } else if (kept) await this.enter(() => this.ask('GET', '/room', undefined, kept.token));
    this.draw();
  }

  openRoom() {
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
          this.came(JSON.parse(data));
          this.draw();
        },
        onConnection: (now) => {
          this.lost = now === 'lost';
          if (now === 'gone') this.ended();
          this.draw();
        },
      });
    } catch (error) {
      if (error instanceof Problem && error.status === 404 && !launchSecret()) keepRoom(null);
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

  /** @param {'follow' | 'own'} kind */
  begin(kind) {
    this.votes = this.choosing = false;
    this.open = null;
    const body = kind === 'own' ? {kind, setup: this.setup, seconds: this.seconds} : {kind};
    return this.act('POST', '/room/rounds', body);
  }

  choose() {
    this.choosing = !this.choosing;
    this.draw();
    if (this.choosing) query('[data-keep=follow]', this.main).scrollIntoView({block: 'nearest'});
  }

  turnNames() {
    this.names = !this.names;
    this.draw();
  }

  /** @param {service.WallView} state */
  came(state) {
    const before = this.state?.round;
    const {round} = state;
    this.state = state;
    this.until = performance.now() + 1000 * (round?.left ?? 0);
    if (before?.number !== round?.number) this.open = null;
    else if (this.open && !before?.revealed && round?.revealed) this.show(this.open);
  }

  get left() {
    return (this.until - performance.now()) / 1000;
  }

  tick() {
    const shown = this.main.querySelector('.wall-clock');
    if (shown) shown.textContent = clock(this.left);
  }

  /** A student's name, or the animal; a number while names are hidden. @param {service.Tile} tile */
  nameOf(tile) {
    const place = this.state?.tiles.findIndex(({id}) => id === tile.id) ?? 0;
    return this.names ? (tile.name ?? named(tile.animal)) : t('page.classroom.nameless', {n: place + 1});
  }

  /** Open the record of a student; null: shut it. @param {string | null} id */
  async show(id) {
    this.open = id;
    this.playing = false;
    this.replay = null;
    if (id === null) return this.draw();
    try {
      /** @type {service.Replay} */
      const replay = await this.ask('GET', `/room/students/${id}/replay`);
      if (this.open !== id) return undefined;
      this.replay = replay;
      this.record.replay(replay, this.state?.round?.horizon ?? 1);
    } catch (error) {
      this.open = null;
      this.refused(error);
    }
    return this.draw();
  }

  /** Let the record pass again in ten seconds, or stop. */
  play() {
    const {replay} = this;
    if (!replay) return;
    this.playing = !this.playing;
    const end = this.state?.round?.horizon ?? 1;
    const rows = replay.values[0]?.length ?? 0;
    const begun = performance.now();
    const next = () => {
      if (this.replay !== replay) return;
      const share = (performance.now() - begun) / 10_000;
      const shown = this.playing ? Math.max(1, Math.min(rows, Math.ceil(share * rows))) : rows;
      this.record.replay({...replay, values: replay.values.map((row) => row.slice(0, shown))}, end);
      if (shown >= rows) this.playing = false;
      this.draw();
      if (this.playing) setTimeout(next, 60);
    };
    next();
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
    const title = this.room ? t('page.classroom.room', {code: this.room.code}) : t('page.classroom.title');
    document.title = `${title} · Thetascope`;
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
        {class: 'run', type: 'button', 'data-keep': 'open', onclick: () => page.openRoom()},
        t('page.classroom.open'),
      ),
    ),
  );
}

await speak(chosenLanguage());
const page = new Classroom();
mountTop(query('header'), connection, 'learn', () => {
  page.record.label();
  page.draw();
});
await page.start();
addEventListener('keydown', (event) => {
  const typing = event.target instanceof Element && event.target.closest('input, select, textarea');
  if (typing || event.ctrlKey || event.metaKey || event.altKey || event.key.toUpperCase() !== 'V') return;
  page.votes = !page.votes;
  page.draw();
});
