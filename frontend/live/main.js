// Starts the live page: creates the app, opens the session of the address, joins sessions and leaves them.

import {get} from '../common/api.js';
import {query} from '../common/dom.js';
import {actions, presented} from './actions.js';
import {keepAddress} from './address.js';
import {mountDesk} from './ui/presentation.js';
import {Edge, createLoop} from './loop.js';
import {mountHysteresis} from './scope/hysteresis.js';
import {mountPlanes} from './scope/planes.js';
import {keepView} from './state/kept-view.js';
import {Arrivals} from './net/missed-rows.js';
import {mountNotice} from './ui/notice.js';
import {mountPanels} from './mount-panels.js';
import {openingSpeed} from './state/opening-speed.js';
import {watchPast} from './state/past.js';
import * as permalink from './state/permalink.js';
import {lead} from './class/lead.js';
import {reduce} from './state/reduce.js';
import {Samples} from './state/samples.js';
import {mountScope} from './scope/scope.js';
import {create, end, fork, kept, library, look} from './net/session.js';
import {connect, Refused} from './net/socket.js';
import {createStore, initial} from './state/store.js';
import {derivedColumns, stripsOf} from './state/strips.js';
import {chosenLanguage} from '../i18n/language.js';
import {mountTimeline} from './ui/session-timeline.js';
import {mountTransport} from './ui/transport.js';
import {named, say, speak, t} from '../i18n/words.js';

/** @import {App, Catalogue, Experiment, Command, Language, ServerMessage, SessionLink, State} from './types.js' */
/** @import {Problem} from '../common/api.js' */

/**
 * @typedef {object} JoinOptions
 * @property {string} id
 * @property {string | null} control   the token, of a session that is controlled from here
 * @property {string | null} experiment
 * @property {boolean} plain           a library experiment without changes
 * @property {State['parent']} [parent]
 * @property {boolean} [fresh]         just created
 * @property {() => void} [then]       called after its first hello
 */

const FIRST = {experiment: 'zhao-2012', t: 12}; // the first fault is 8 s ahead: time to look around, and then it comes

const store = createStore({...initial, theme: window.theme.now, language: chosenLanguage()}, reduce);
const loop = createLoop();
/** @type {ReturnType<typeof connect> | null} */
let socket = null;
/** @type {ReturnType<typeof connect> | null} */
let ghostSocket = null;
/** @type {string | null} */
let token = null;

const app = /** @type {App} */ (
  /** @type {Omit<App, 'act' | 'scope'>} */ ({
    store,
    samples: new Samples(1),
    ghost: null, // the parent's samples; state.origin has the rest
    edge: new Edge(),
    first: FIRST.experiment,
    get state() {
      return store.state;
    },
    get catalogue() {
      const {language} = store.state;
      if (catalogue?.language !== language) catalogue = {language, answer: get('/api/catalogue')};
      return catalogue.answer;
    },
    subscribe: store.subscribe,
    wake: loop.wake,
    onFrame: loop.onFrame,
    onTick: (fn) => loop.onTick(() => fn(app.samples.now)),
    latest: (column) => app.samples.latest(column),
    at: (column, t) => app.samples.at(column, t),
    window: (column, t0, t1) => app.samples.window(column, t0, t1),
    range: (column, t0, t1) => app.samples.range(column, t0, t1),
    strips: () => stripsOf(store.state),
    span: () => scope.span(),
    cursor: (t) => store.dispatch({type: 'set', cursor: t}),
    drop: () => socket?.drop(),
    send(command) {
      if (!socket) return Promise.reject(new Refused({code: 'page.notice.no-session'}));
      if (store.state.role === 'view') return Promise.reject(new Refused({code: 'page.notice.view-only'}));
      return socket.send(command);
    },
  })
);
/** @type {{language: Language, answer: Promise<Catalogue>} | null} */
let catalogue = null;

const address = keepAddress(app, () => token);

let turns = 0; // sessions asked for

/** Ask for another session. Returns whether it is still the newest one asked for: the answers of others are dropped. */
function turn() {
  const mine = (turns += 1);
  return () => mine === turns;
}

// ---- joining and leaving a session

function leave() {
  socket?.stop();
  ghostSocket?.stop();
  socket = ghostSocket = app.ghost = null;
}

/**
 * Join a session: its messages go to the store, its frames to the samples. `then` is called when it has said hello for
 * the first time.
 * @param {JoinOptions} options
 */
function join({id, control, experiment, plain, parent = null, fresh = false, then = () => {}}) {
  leave();
  token = control;
  const samples = (app.samples = new Samples(1));
  const arrivals = new Arrivals(samples, id, loop.wake);
  store.dispatch({type: 'begin', session: id, role: control ? 'control' : 'view', experiment, parent});
  store.dispatch({type: 'set', begunPlain: plain});
  let first = true;
  socket = connect({
    session: id,
    token: control,
    onConnection: (now) => store.dispatch({type: 'connection', now}),
    onFrame: (frame) => arrivals.frame(frame),
    onMessage(message) {
      prepare(samples, arrivals, message);
      store.dispatch(message);
      if (message.type === 'hello' && first) {
        first = false;
        app.edge.t = Infinity; // anything but where the last session was
        if (message.parent) watchParent(message.parent);
        if (message.role === 'view') app.act.tell({code: 'page.notice.view-only'});
        if (fresh) app.act.speed(openingSpeed(message.spec));
        then();
      }
      if (message.type === 'ack') address.soon();
      loop.wake();
    },
  });
}

/**
 * Prepare the samples for a message, before the store gets it.
 * @param {Samples} samples
 * @param {Arrivals} arrivals
 * @param {ServerMessage} message
 */
function prepare(samples, arrivals, message) {
  if (message.type === 'hello') {
    if (samples.epoch !== message.epoch || samples.record !== message.record)
      samples.truncate(samples.epoch === undefined ? 0 : Math.min(samples.rows, message.row));
    samples.record = message.record;
  } else if (message.type === 'rewound') samples.truncate(message.row);
  if (message.type === 'hello' || message.type === 'columns')
    samples.setColumns(message.columns, derivedColumns(message.columns));
  if ('epoch' in message) samples.epoch = message.epoch;
  if (message.type === 'jump') arrivals.jump(message);
}

/**
 * The parent's curves, faintly behind: a second, read-only connection.
 * @param {string} id
 */
function watchParent(id) {
  const samples = new Samples(1, 24e6);
  const arrivals = new Arrivals(samples, id, loop.wake);
  let known = reduce(initial, {type: 'begin', session: id, role: 'view', experiment: null});
  ghostSocket = connect({
    session: id,
    token: null,
    onFrame: (frame) => arrivals.frame(frame),
    onMessage(message) {
      prepare(samples, arrivals, message);
      app.ghost = samples;
      known = reduce(known, message);
      const {observers, faults, alarms} = known;
      const {origin} = store.state;
      const same =
        origin !== null && origin.observers === observers && origin.faults === faults && origin.alarms === alarms;
      if (known.spec && !same) store.dispatch({type: 'set', origin: {observers, faults, alarms}});
    },
    onConnection(now) {
      if (now === 'ended' && app.ghost === null) store.dispatch({type: 'set', parent: null});
    },
  });
}

/** @type {SessionLink} */
const link = {
  token: () => token,
  /** Begin a session with an experiment of the library or a spec. */
  async begin({experiment = null, spec = null, t = 0, play = true, then}) {
    const wanted = turn();
    try {
      const opened = await create({...(spec ? {spec} : {experiment}), play, t});
      if (wanted()) join({id: opened.id, control: opened.token, experiment, plain: spec === null, fresh: true, then});
      else await end(opened.id, opened.token);
    } catch (error) {
      if (wanted()) failed(error);
    }
  },
  async fork(at) {
    const {session, experiment, begunPlain} = store.state;
    if (session === null) return;
    const wanted = turn();
    const now = at ?? app.samples.now;
    try {
      await address.write();
      const opened = await fork(session, token, at);
      if (!wanted()) {
        await end(opened.id, opened.token);
        return;
      }
      const parent = {id: session, t: now};
      kept.write({id: opened.id, token: opened.token, address: '', experiment, plain: begunPlain, parent});
      history.pushState({session: opened.id}, '', location.href); // the browser's Back leads to the first one
      join({
        id: opened.id,
        control: opened.token,
        experiment,
        plain: begunPlain,
        parent,
        then: () => app.act.tell({code: 'page.notice.forked', args: {t: now.toFixed(1)}}),
      });
    } catch (error) {
      app.act.refused(error);
    }
  },
  /**
   * Begin again from t = 0 with another spec, in another session; Undo and the browser's Back lead to this one.
   * Throws where the spec is refused.
   * @param {Experiment} spec
   */
  async restart(spec) {
    const {session, experiment, playing, speed} = store.state;
    if (session === null) return;
    const wanted = turn();
    await address.write();
    const opened = await create({spec, play: playing, t: 0});
    if (!wanted()) return void (await end(opened.id, opened.token));
    kept.write({id: opened.id, token: opened.token, address: '', experiment, plain: false, parent: null});
    history.pushState({session: opened.id}, '', location.href);
    const action = {message: {code: 'page.action.undo'}, act: () => link.visit(session)};
    join({
      id: opened.id,
      control: opened.token,
      experiment,
      plain: false,
      then() {
        app.act.speed(speed);
        app.act.tell({code: 'page.notice.started-again'}, {action});
      },
    });
  },
  /**
   * Go to another session of this tab: the one that this was forked from, or one that was forked from this.
   * @param {string} id
   */
  async visit(id) {
    const wanted = turn();
    await address.write();
    if (!wanted()) return;
    history.pushState({session: id}, '', kept.of(id) ? location.href : `/?session=${encodeURIComponent(id)}`);
    try {
      const joined = await address.arrive(() => rejoin(id, wanted));
      if (!joined && wanted()) app.act.tell({code: 'page.notice.session-ended'}, {kind: 'problem'});
    } catch (error) {
      if (wanted()) app.act.refused(error);
    }
  },
};

/**
 * Join a session that this tab has had before, if it is still there and still wanted. Throws where that is not known:
 * another session in its place would lose it.
 * @param {string} id
 * @param {() => boolean} wanted
 */
async function rejoin(id, wanted) {
  const known = kept.of(id);
  if (!(await look(id)) || !wanted()) return false;
  join({
    id,
    control: known?.token ?? null,
    experiment: known?.experiment ?? null,
    plain: known?.plain ?? false,
    parent: known?.parent ?? null,
  });
  return true;
}

/**
 * Show why there is no session.
 * @param {unknown} error   as thrown
 */
function failed(error) {
  const {title, detail, message} = /** @type {Partial<Problem>} */ (error);
  const problem = {title: say(title ?? t('page.notice.failed')), detail: say(detail ?? message)};
  store.dispatch({type: 'failed', problem});
}

/** Open the session of the address; without one, the first experiment, already running. */
async function open() {
  const wanted = turn();
  /** @type {Awaited<ReturnType<typeof permalink.read>>} */
  let request;
  try {
    request = await permalink.read(location);
  } catch {
    return wanted() ? failed({title: t('page.notice.damaged-link'), detail: ''}) : undefined;
  }
  const mine = kept.read();
  const here = location.search + location.hash;
  const own = [history.state?.session, mine?.address === here && here && mine.id].find((id) => id && kept.of(id));
  try {
    if (own && (await rejoin(own, wanted))) return undefined;
  } catch (error) {
    return wanted() ? failed(error) : undefined;
  }
  if (!wanted()) return undefined;
  if (request.session)
    return join({
      id: request.session,
      control: kept.of(request.session)?.token ?? null,
      experiment: null,
      plain: false,
    });
  const linked = request.t > 0 || request.changed || (request.spec && !request.play);
  const then = linked
    ? () => app.act.tell({code: 'page.notice.from-link', args: {t: request.t.toFixed(1)}})
    : undefined;
  try {
    const spec = await permalink.specOf(request, library);
    if (!wanted()) return undefined;
    if (spec) {
      const opened = await create({spec, t: request.t, play: request.play === true});
      if (!wanted()) return await end(opened.id, opened.token);
      return join({
        id: opened.id,
        control: opened.token,
        experiment: request.experiment ?? null,
        plain: false,
        fresh: true,
        then,
      });
    }
  } catch (error) {
    return wanted() ? failed(error) : undefined;
  }
  if (request.experiment) return link.begin({experiment: request.experiment, t: request.t, play: !linked, then});
  return link.begin({experiment: FIRST.experiment, t: FIRST.t, play: true});
}

/**
 * Show a lesson of the course; after a reload it finds its session again.
 * @param {string} id
 */
async function teach(id) {
  const {startLesson} = await import('./lesson/lesson.js');
  const own = history.state?.session;
  await startLesson(id, app, {link, again: async (of) => Boolean(of ?? own) && rejoin(of ?? own, turn())});
}

// ---- the page

app.act = actions(app, link);
/** @param {string} id */
const place = (id) => query(`#${id}`);
window.thetascope = app; // for the console, and for the tests
await speak(store.state.language);
const scope = (app.scope = mountScope(place('scope'), app));
mountHysteresis(place('hysteresis'), app);
mountPlanes(place('planes'), app);
mountTimeline(place('timeline'), app);
mountTransport(place('transport'), app);
mountNotice(place('notice'), app);
watchPast(app);
keepView(app);
mountDesk(place('main'), app);
if (presented()) app.act.present(true);
lead.mount(app);
store.subscribe((state) => [state.spec, state.epoch, state.playing, state.session], address.soon);
store.subscribe(
  (state) => [state.spec?.title, state.language],
  ([title]) => {
    document.title = title ? `${named(title)} · Thetascope` : 'Thetascope';
  },
);
addEventListener('theme', ({detail}) => store.dispatch({type: 'set', theme: detail}));
addEventListener('popstate', () => address.arrive(open));
const lesson = new URLSearchParams(location.search).get('lesson');
await Promise.all([mountPanels(app), lesson === null ? open() : teach(lesson)]);
