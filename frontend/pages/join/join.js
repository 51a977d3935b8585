// A student's phone: join a room by its code, follow the teacher, vote. What is half made is kept on the device.

import {fill, h, query} from '../../common/dom.js';
import {post, request} from '../../common/api.js';
import {chosenLanguage, rememberLanguage} from '../../i18n/language.js';
import {asSentence, language, named, refusalWords, speak, t} from '../../i18n/words.js';
import {keepSeat, studentSeat} from '../classroom/kept.js';
import {CurvePicture} from '../classroom/curve-picture.js';
import {RoomSocket} from '../classroom/room-socket.js';
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
    /** @type {RoomSocket[]} */
    this.sockets = [];
    this.main = query('#main');
    this.head = query('.seat-head');
    this.foot = query('.seat-foot');
    /** the choice that is not sent yet, and for which step @type {{step: string, choice: number} | null} */
    this.draft = kept.read();
    this.renaming = false;
    this.busy = false;
    this.unfolded = false;
  }

  async start() {
    const code = decodeURIComponent(location.pathname.split('/')[2] ?? '');
    const seat = studentSeat();
    if (seat && (!code || seat.code === code.toUpperCase())) return this.sit(seat);
    if (code) await this.join(code);
    return this.draw();
  }

  /** @param {string} code */
  async join(code) {
    this.problem = '';
    try {
      /** @type {service.JoinedRoom} */
      const {token, seat} = await post('/api/classroom/join', {code});
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
          this.state = JSON.parse(data);
          this.draw();
        },
        onConnection: (now) => (now === 'live' || now === 'lost' ? this.connected(now) : this.gone(now)),
      }),
      new RoomSocket({
        path: '/api/classroom/seat/curves',
        token,
        onMessage: (data) => this.picture.receive(data),
      }),
    ];
    this.draw();
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
    kept.write(draft);
    this.draw();
  }

  drawHead() {
    const {state} = this;
    const lost = this.connection === 'lost';
    fill(
      this.head,
      h('b', {}, state ? t('page.join.room', {code: state.code}) : 'Thetascope'),
      h('span', {class: 'grow'}),
      state &&
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
    this.draw();
  }

  draw() {
    const {state} = this;
    document.title = `${state ? t('page.join.room', {code: state.code}) : t('page.join.title')} · Thetascope`;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.keep : undefined;
    this.drawHead();
    const lead = state?.round?.lead;
    if (!this.seat || !state) drawJoin(this);
    else if (this.renaming || !lead || (!lead.card && !lead.live)) drawWaiting(this, state);
    else drawFollow(this, state, lead);
    if (focused) /** @type {HTMLElement | null} */ (document.querySelector(`[data-keep="${focused}"]`))?.focus();
  }

  /** The student's name, or the animal. */
  get called() {
    return this.state?.name ?? named(this.state?.animal);
  }
}

/** The choice that is not sent yet. */
const kept = {
  /** @returns {{step: string, choice: number} | null} */
  read() {
    try {
      return JSON.parse(localStorage.getItem('thetascope.draft') ?? 'null');
    } catch {
      return null;
    }
  },
  /** @param {{step: string, choice: number} | null} draft */
  write(draft) {
    try {
      localStorage.setItem('thetascope.draft', JSON.stringify(draft));
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
