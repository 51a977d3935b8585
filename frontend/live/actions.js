// Actions that are more than one command (README.md lists them).

import {noteActions} from './notes/note-actions.js';
import {picture} from './scope/figure.js';
import {seconds} from '../widgets/number-format.js';
import * as permalink from './state/permalink.js';
import {library, save} from './net/session.js';
import {rememberLanguage} from '../i18n/language.js';
import {refusalWords, speak, t} from '../i18n/words.js';

/** @import {Message} from '../i18n/render.js' */
/** @import {Actions, App, Command, Language, NoticeLine, SessionLink, State} from './types.js' */

const PRESENTED = 'thetascope.presentation'; // of this tab: the page comes back as it was when it is loaded again

/**
 * @param {App} app
 * @param {SessionLink} link
 * @returns {Actions}
 */
export const actions = (app, link) => ({
  ...transport(app, link),
  ...sessions(app, link),
  ...looks(app),
  notes: noteActions(app, (command) => ask(app, command)),
});

/** @param {App} app @param {Partial<State>} values */
const set = (app, values) => app.store.dispatch({type: 'set', ...values});

/**
 * Show a message in the notice; it is rendered there, so that it follows the language.
 * @param {App} app
 * @param {Message | string} message
 * @param {{kind?: NoticeLine['kind'], action?: NoticeLine['action']}} [how]
 */
const tell = (app, message, {kind = 'note', action = null} = {}) =>
  set(app, {notice: {message, kind, action, at: performance.now()}});

/**
 * A refusal in a line: the problem and its remedy.
 * @param {unknown} error   as thrown
 */
export function refused(error) {
  const {problem, remedy} = refusalWords(error);
  return remedy ? t('page.text.semicolon', {first: problem, second: remedy}) : problem;
}

/**
 * Send a command and show its refusal on the page. Returns the Ack, or null.
 * @param {App} app
 * @param {Command} command
 */
async function ask(app, command) {
  try {
    return await app.send(command);
  } catch (error) {
    tell(app, refused(error), {kind: 'problem'});
    return null;
  }
}

/**
 * @param {App} app
 * @param {SessionLink} link
 * @returns {Pick<Actions, 'together' | 'play' | 'pause' | 'toggle' | 'step' | 'speed' | 'reset' | 'seek'>}
 */
function transport(app, link) {
  /** @param {Command} command */
  const send = (command) => ask(app, command);
  /**
   * Go back to a time and discard what came after it; for a while this can be undone, with another session of the same
   * history.
   * @param {Command} command
   * @param {number} at
   */
  async function goBack(command, at) {
    const {spec, experiment} = app.state;
    const now = app.samples.now;
    if (!(await send(command))) return;
    const undo = () => link.begin({spec, experiment, t: now, play: false});
    tell(
      app,
      {code: 'page.notice.went-back', args: {t: seconds(at, 0.1)}},
      {
        action: {message: {code: 'page.action.undo'}, act: undo, alone: true},
      },
    ); // those who watch would stay behind
  }
  return {
    /** Commands that belong together: all of them act from the same row on, or none does. */
    together: (commands) => app.send(commands.length === 1 ? commands[0] : {type: 'batch', commands}),
    play: () => send({type: 'play'}),
    pause: () => send({type: 'pause'}),
    toggle: () => send({type: app.state.playing ? 'pause' : 'play'}),
    step: (rows = 1) => send({type: 'step', rows}),
    speed: (value) => send({type: 'speed', value}),
    reset: () => goBack({type: 'reset'}, 0),
    seek: (t) => goBack({type: 'seek', t}, t),
  };
}

/**
 * @param {App} app
 * @param {SessionLink} link
 * @returns {Pick<Actions, 'open' | 'openSpec' | 'fork' | 'visit' | 'restart' | 'save' | 'link'>}
 */
function sessions(app, link) {
  return {
    open: (id) => link.begin({experiment: id ?? app.first, play: true}),
    openSpec: (spec, {t = 0} = {}) => link.begin({spec, t, play: false, experiment: app.state.experiment}),
    fork: (t) => link.fork(t),
    visit: (id) => link.visit(id),
    restart: (spec) => link.restart(spec),
    save: () => save(app.state.session ?? '', link.token()),
    async link({view = false} = {}) {
      if (view) return `${location.origin}/?session=${encodeURIComponent(app.state.session ?? '')}`;
      return `${location.origin}/${await addressOf(app)}`;
    },
  };
}

/**
 * @param {App} app
 * @returns {Omit<Actions, 'notes' | keyof ReturnType<typeof transport> | keyof ReturnType<typeof sessions>>}
 */
function looks(app) {
  return {
    window: (length) => set(app, {window: length, selection: null, looking: null}),
    select(t0, t1) {
      const least = 4 * app.state.record;
      set(app, {
        looking: null,
        selection: t0 === null || t1 === undefined || t1 - t0 < least ? null : [Math.max(0, t0), t1],
      });
    },
    /**
     * Look back to a time of the past (null: at now again); nothing is given up.
     * @param {number | null} t
     */
    look(t) {
      const length = app.state.window ?? Math.max(app.samples.now, 10);
      const end = Math.max(t ?? 0, length);
      set(app, {looking: t, selection: t === null ? null : [end - length, end]});
    },
    band: (label) => set(app, {band: label}),
    strip(name, shown) {
      if (name === null) set(app, {strips: {}});
      else if (shown !== undefined) app.store.dispatch({type: 'strip', name, shown});
    },
    plane(place, plane) {
      const {planes} = app.state;
      const others = plane === null ? [] : [plane];
      set(app, {planes: [...planes.slice(0, place), ...others, ...planes.slice(place + 1)]});
    },
    table: (on) => set(app, {table: on}),
    site: (name) => set(app, {site: name}),
    present(on) {
      document.documentElement.classList.toggle('presentation', on);
      keep(sessionStorage, PRESENTED, on ? 'on' : null);
      set(app, {presentation: on});
    },
    desk: (name) => set(app, {desk: name}),
    theme(wanted) {
      if (wanted !== null && wanted !== window.theme.now) window.theme.toggle();
    },
    /** @param {Language} language */
    async language(language) {
      await speak(language);
      rememberLanguage(language);
      set(app, {language});
    },
    tell: (message, how) => tell(app, message, how),
    refused: (error) => tell(app, refused(error), {kind: 'problem'}),
    figure: (what) => picture(app, what),
  };
}

/**
 * Keep a word, or (null) forget it.
 * @param {Storage} storage
 * @param {string} name
 * @param {string | null} value
 */
function keep(storage, name, value) {
  try {
    if (value === null) storage.removeItem(name);
    else storage.setItem(name, value);
  } catch {
    /* private windows keep nothing */
  }
}

/** @param {Storage} storage @param {string} name */
function kept(storage, name) {
  try {
    return storage.getItem(name);
  } catch {
    return null;
  }
}

/** Whether this tab was presenting when it was loaded again. */
export const presented = () => kept(sessionStorage, PRESENTED) === 'on';

const DONE = new Set(['inject', 'clear', 'gain', 'signal', 'noise', 'truth', 'observer-added', 'observer-removed']);

/**
 * The address of the session as it is now: the short form while a library experiment is unchanged.
 * @param {App} app
 */
export async function addressOf(app) {
  const {lesson} = app.state;
  if (lesson) return `?lesson=${encodeURIComponent(lesson.id)}&step=${lesson.place + 1}`;
  const {state} = app;
  const t = app.samples.now;
  if (!state.spec) return location.search + location.hash;
  const base = state.experiment ? await library(state.experiment) : null;
  const untouched =
    base !== null && state.begunPlain && !state.spec.notes.length && !state.log.some((event) => DONE.has(event.kind));
  return permalink.write({spec: untouched ? base : state.spec, t, experiment: state.experiment, base});
}
