// A student's phone: join a room by its code, follow the teacher, vote. What is half made is kept on the device.

import {fill, h, query} from '../../common/dom.js';
import {post, request} from '../../common/api.js';
import {chosenLanguage, rememberLanguage} from '../../i18n/language.js';
import {asSentence, language, named, refusalWords, speak, t} from '../../i18n/words.js';
import {keepSeat, launchSecret, studentSeat} from '../classroom/kept.js';
import {CurvePicture} from '../classroom/curve-picture.js';
import {RoomSocket} from '../classroom/room-socket.js';
import {decode} from '../../live/net/socket.js';
import {clock} from '../classroom/answer-words.js';
import {RecordPictures} from '../classroom/record-pictures.js';
import {drawFaults} from './faults.js';
import {drawFollow} from './follow.js';
import {drawJoin, drawWaiting} from './waiting.js';

/** @import * as service from '../../types/service.js' */

const BY_ADDRESS = 'X-Seat-Token';

export class Phone {
  constructor() {
    /** @type {import('../classroom/kept.js').Kept | null} */
    this.seat = null;
    /** @type {service.SeatView | null} */
    this.state = null;
    /** @type {'live' | 'lost'} */
    this.connection = 'lost';
    this.problem = '';
    this.picture = new CurvePicture();
    this.record = new RecordPictures();
    this.until = 0; // when the answers are revealed, on the clock of this page
    setInterval(() => this.tick(), 500);
    /** @type {RoomSocket[]} */
    this.sockets = [];
    this.main = query('#main');
    this.head = query('.seat-head');
    this.foot = query('.seat-foot');
    /** the choice that is not sent yet, and for which step @type {{step: string, choice: number} | null} */
    this.draft = kept.read('thetascope.vote');
    /** the answer that is not sent yet @type {import('./faults.js').Draft | null} */
    this.answer = kept.read('thetascope.answer');
    this.renaming = false;
    this.busy = false;
    this.unfolded = false;
  }

  async start() {
    const code = decodeURIComponent(location.pathname.split('/')[2] ?? '');
    const launch = launchSecret();
    if (launch) {
      await this.join('/api/classroom/lti/seat', {launch});
      return this.draw();
    }
    const seat = studentSeat();
    if (seat && (!code || seat.code === code.toUpperCase())) return this.sit(seat);
    if (code) await this.join('/api/classroom/join', {code});
    return this.draw();
  }

  /**
   * Take a place in a room.
   * @param {string} path
   * @param {object} by   its code, or a launch from a learning platform
   */
  async join(path, by) {
    this.problem = '';
    try {
      /** @type {service.JoinedRoom} */
      const {token, seat} = await post(path, by);
      keepSeat({token, code: seat.code});
      history.replaceState(null, '', `/join/${seat.code}`);
      this.state = seat;
      this.sit({token, code: seat.code});
    } catch (error) {
      this.problem = sentence(error);
      this.draw();
    }
  }

  /** @param {import('../classroom/kept.js').Kept} seat */
  sit(seat) {
    this.seat = seat;
    const {token} = seat;
    for (const socket of this.sockets) socket.stop();
    this.sockets = [
      new RoomSocket({
        path: '/api/classroom/seat/stream',
        token,
        onMessage: (data) => {
          if (typeof data !== 'string') return;
          this.state = /** @type {service.SeatView} */ (JSON.parse(data));
          this.until = performance.now() + 1000 * (this.state.round?.left ?? 0);
          this.draw();
        },
        onConnection: (now) => (now === 'live' || now === 'lost' ? this.connected(now) : this.gone(now)),
      }),
      new RoomSocket({
        path: '/api/classroom/seat/curves',
        token,
        onMessage: (data) => this.curves(data),
      }),
    ];
    this.draw();
  }

  /** Curves of the teacher's session, or of the record of one's own. @param {string | ArrayBuffer} data */
  curves(data) {
    if (typeof data !== 'string') {
      if (this.record.head) this.played(data);
      else this.picture.receive(data);
      return;
    }
    /** @type {service.CurvesHead} */
    const head = JSON.parse(data);
    if (head.panels.length) this.record.begin(head);
    else {
      this.record.head = null;
      this.picture.begin(head);
    }
    this.draw();
  }

  /** Rows of the record of one's own; with the first of them it can be answered. @param {ArrayBuffer} data */
  played(data) {
    const first = this.record.empty;
    this.record.add(decode(data));
    if (first) this.draw();
  }

  /** The time that is left; sliders follow the record. */
  tick() {
    const left = this.head.querySelector('.left');
    if (left) left.textContent = clock((this.until - performance.now()) / 1000);
    const since = document.querySelector('#since');
    if (since instanceof HTMLInputElement && since !== document.activeElement)
      since.max = String(Math.max(this.record.now, Number(since.value)));
  }

  /** @param {'live' | 'lost'} now */
  connected(now) {
    if (this.connection === now) return;
    this.connection = now;
    this.drawHead();
  }

  /** @param {'gone' | 'elsewhere'} why */
  gone(why) {
    for (const socket of this.sockets) socket.stop();
    this.sockets = [];
    if (why === 'gone') keepSeat(null);
    this.seat = this.state = null;
    this.problem = why === 'gone' ? t('page.join.ended') : t('page.join.elsewhere');
    this.draw();
  }

  async leave() {
    await this.ask('DELETE', '');
    this.gone('gone');
    this.problem = '';
    history.replaceState(null, '', '/join');
    this.draw();
  }

  /**
   * Send something about the seat; the answer is its state.
   * @param {string} method @param {string} path @param {unknown} [body]
   */
  async ask(method, path, body) {
    this.problem = '';
    this.busy = true;
    try {
      const state = await request(method, `/api/classroom/seat${path}`, {
        body,
        headers: {[BY_ADDRESS]: this.seat?.token ?? ''},
      });
      if (state) this.state = /** @type {service.SeatView} */ (state);
      return true;
    } catch (error) {
      this.problem = sentence(error);
      return false;
    } finally {
      this.busy = false;
      this.draw();
    }
  }

  /** @param {{step: string, choice: number} | null} draft */
  keep(draft) {
    this.draft = draft;
    kept.write('thetascope.vote', draft);
    this.draw();
  }

  /** @param {import('./faults.js').Draft} answer @param {boolean} [again]   whether to draw the page again */
  keepAnswer(answer, again = true) {
    this.answer = answer;
    kept.write('thetascope.answer', answer);
    if (again) this.draw();
  }

  drawHead() {
    const {state} = this;
    const lost = this.connection === 'lost';
    const own = state?.round?.kind === 'own' ? state.round : null;
    const left =
      own &&
      !lost &&
      (own.revealed
        ? h('span', {class: 'soft'}, t('page.class.revealed'))
        : own.left !== null &&
          h(
            'span',
            {class: 'soft left', 'aria-label': t('page.class.left')},
            clock((this.until - performance.now()) / 1000),
          ));
    fill(
      this.head,
      h(
        'b',
        {},
        own ? t('page.join.round', {n: own.number}) : state ? t('page.join.room', {code: state.code}) : 'Thetascope',
      ),
      h('span', {class: 'grow'}),
      left,
      state &&
        !left &&
        h(
          'span',
          {class: lost ? 'connection lost' : 'connection', role: 'status'},
          h('span', {class: 'dot'}),
          lost ? t('page.header.connection-lost') : t('page.header.connected'),
        ),
      h(
        'button',
        {
          class: 'quiet languages',
          type: 'button',
          'aria-label': t('page.header.language.hint'),
          onclick: () => this.turn(),
        },
        language() === 'zh' ? 'EN' : '中文',
      ),
    );
  }

  async turn() {
    const other = language() === 'zh' ? 'en' : 'zh';
    rememberLanguage(other);
    await speak(other);
    this.picture.label();
    this.record.label();
    this.draw();
  }

  draw() {
    const {state} = this;
    document.title = `${state ? t('page.join.room', {code: state.code}) : t('page.join.title')} · Thetascope`;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.keep : undefined;
    this.drawHead();
    const lead = state?.round?.lead;
    if (!this.seat || !state) drawJoin(this);
    else if (!this.renaming && state.round?.kind === 'own') drawFaults(this, state, state.round);
    else if (this.renaming || !lead || (!lead.card && !lead.live)) drawWaiting(this, state);
    else drawFollow(this, state, lead);
    if (focused) /** @type {HTMLElement | null} */ (document.querySelector(`[data-keep="${focused}"]`))?.focus();
  }

  /** The student's name, or the animal. */
  get called() {
    return this.state?.name ?? named(this.state?.animal);
  }
}

/** What is half made, on this device. */
const kept = {
  /** @param {string} key */
  read(key) {
    try {
      return JSON.parse(localStorage.getItem(key) ?? 'null');
    } catch {
      return null;
    }
  },
  /** @param {string} key @param {unknown} value */
  write(key, value) {
    try {
      localStorage.setItem(key, JSON.stringify(value));
    } catch {
      /* private windows keep nothing */
    }
  },
};

/** @param {unknown} error */
function sentence(error) {
  const {problem, remedy} = refusalWords(error);
  return [problem, remedy].map(asSentence).filter(Boolean).join(' ');
}

await speak(chosenLanguage());
await new Phone().start();
