// Where a room is open in this browser and its students follow, what this page shows goes to them: the session, its
// first strip, and in a lesson the words and the question of the step. Votes come back.

import {request} from '../../common/api.js';
import {teacherRoom} from '../../pages/classroom/kept.js';
import {RoomSocket} from '../../pages/classroom/room-socket.js';

/** @import {App, Strip} from '../types.js' */
/** @import {Lesson} from '../lesson/lesson.js' */
/** @import * as service from '../../types/service.js' */

const PAUSE = 120; // ms for which changes are gathered

class Lead {
  constructor() {
    /** @type {App | null} */
    this.app = null;
    /** @type {Lesson | null} */
    this.lesson = null;
    /** @type {service.WallView | null} */
    this.wall = null;
    this.shown = false; // the votes are
    this.sent = '';
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.token = '';
  }

  /** @param {App} app */
  mount(app) {
    const room = teacherRoom();
    if (!room) return;
    this.app = app;
    this.token = room.token;
    const socket = new RoomSocket({
      path: '/api/classroom/room/stream',
      token: room.token,
      onMessage: (data) => {
        if (typeof data !== 'string') return;
        /** @type {service.WallView} */
        const wall = JSON.parse(data);
        if (wall.round?.number !== this.wall?.round?.number) this.sent = '';
        this.wall = wall;
        this.soon();
        this.lesson?.draw();
      },
      onConnection: (now) => {
        if (now === 'gone') this.wall = null;
        else if (now === 'live') this.sent = '';
      },
    });
    addEventListener('pagehide', () => socket.stop());
    addEventListener('pageshow', (event) => event.persisted && location.reload());
    document.addEventListener('visibilitychange', () => this.soon());
    app.subscribe(
      (state) => [state.session, state.lesson, state.strips, state.columns, state.role],
      () => this.soon(),
    );
  }

  /** Whether students follow this page now. */
  get follows() {
    return this.wall?.round?.kind === 'follow';
  }

  /** How many have voted for each answer of the step that is shown, and whether that is to be seen. */
  get votes() {
    const {wall, lesson} = this;
    if (!wall || !lesson || !this.follows) return null;
    const mine = wall.round?.lead?.step === stepName(lesson);
    return {
      counts: mine ? wall.votes : [],
      voted: mine ? wall.tiles.filter((tile) => tile.answered).length : 0,
      students: wall.tiles.length,
      shown: this.shown || lesson.view.phase === 'after',
    };
  }

  show() {
    this.shown = !this.shown;
    this.lesson?.draw();
  }

  /** Send what is shown, soon. */
  soon() {
    if (!this.follows || this.timer !== undefined) return;
    this.timer = setTimeout(() => {
      this.timer = undefined;
      this.send();
    }, PAUSE);
  }

  async send() {
    const {app} = this;
    if (!app || !this.follows || document.visibilityState === 'hidden' || app.state.role === 'view') return;
    const body = this.body(app);
    const text = JSON.stringify(body);
    if (text === this.sent) return;
    this.sent = text;
    try {
      await request('POST', '/api/classroom/room/lead', {body, headers: {'X-Teacher-Token': this.token}});
    } catch {
      this.sent = ''; // the round has ended meanwhile, or the step cannot be sent; the next change is tried again
    }
  }

  /** @param {App} app @returns {service.LeadRequest} */
  body(app) {
    const strips = app.strips().filter((strip) => strip.shown && !strip.log);
    const strip = strips.map(stripOf).find((one) => one !== null) ?? null;
    const base = {session: app.state.session ?? '', strip};
    const {lesson} = this;
    if (!lesson || !app.state.lesson) return base;
    const {view, step} = lesson;
    const seconds = step.run?.seconds ?? 0;
    const phase = view.phase === 'opening' ? 'before' : view.phase;
    return {
      ...base,
      step: stepName(lesson),
      phase,
      since: seconds ? Math.max(0, view.mark - 2 * seconds) : null,
      until: phase === 'before' && seconds ? view.mark + seconds : null,
      right: phase === 'after' ? (view.judged?.right ?? []) : [],
      card: {
        place: view.place + 1,
        of: view.plan.steps.length,
        title: words(step.title),
        say: (step.short ? [step.short] : step.say).slice(0, 3).map(words),
        ask: step.ask ? words(step.ask) : null,
        options: (step.answers ?? []).map(({text}) => words(text)),
      },
    };
  }
}

/** @param {Lesson} lesson */
const stepName = ({view}) => `${view.plan.id} ${view.place + 1}`;

/**
 * Words for the wire, in both languages.
 * @param {service.Words | {readonly [language: string]: string} | string} text
 */
function words(text) {
  if (typeof text === 'string') return {en: text, zh: text};
  const known = /** @type {{[language: string]: string}} */ (text);
  return {en: known.en ?? known.zh ?? '', zh: known.zh ?? known.en ?? ''};
}

/** A strip as phones show it; null where it has no curves that can be sent. @param {Strip} strip */
function stripOf({symbol, kind, title, unit, truth, reading, traces}) {
  /** @type {service.CurveLine[]} */
  const lines = [];
  if (truth) lines.push({column: truth, role: 'truth', place: 0, minus: null});
  if (reading) lines.push({column: reading.column, role: 'measured', place: 0, minus: null});
  for (const {label, column, place} of traces)
    if (kind === 'residual')
      lines.push({column: `y.${symbol}`, minus: `${label}.y.${symbol}`, role: 'estimate', place});
    else lines.push({column, role: 'estimate', place, minus: null});
  if (lines.length === 0) return null;
  const named = /** @type {service.Words | string} */ (title ?? '');
  return {symbol, residual: kind === 'residual', title: title ? words(named) : null, unit, lines: lines.slice(0, 8)};
}

export const lead = new Lead();
