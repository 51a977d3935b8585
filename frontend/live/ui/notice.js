// The notice: a line for some seconds or, while the session cannot go on, until it can.

import {fill, h, number} from '../../common/dom.js';
import {called} from '../../common/names.js';
import {seconds} from '../../widgets/number-format.js';
import {seconds as timed} from '../../widgets/controls.js';
import {stand, isInHeader, watchRoom} from './free-place.js';
import {say, t} from '../../i18n/words.js';

/** @import {App, State} from '../types.js' */
/** @import {Child} from '../../types/dom.js' */

/** @typedef {{kind: string, words: Child, buttons?: Child[]}} Notice */

const SHOWN = 6000; // ms
const OFFERED = 14_000; // ms, where there is something to click on
const BEFORE = 0.2; // of the time at which a plant diverged: how much earlier the session can be continued
const PATIENCE = 700; // ms of a lost connection before it is worth a word

/** @param {string} words @param {() => void} act */
const button = (words, act) => h('button', {type: 'button', class: 'quiet', onclick: act}, words);

/** @param {HTMLElement} root @param {App} app */
export function mountNotice(root, app) {
  let timer = 0;
  /** @param {Notice} notice */
  const show = ({kind, words, buttons = []}) => {
    root.className = kind;
    root.hidden = false;
    fill(root, h('span', {}, words), buttons);
    place();
  };
  const place = () => {
    if (root.hidden || !root.childElementCount) return;
    const choice = isInHeader('.choice:not([hidden])');
    stand(root, {breaks: true, taken: choice === true, crowded: choice === false});
  };
  watchRoom(place);
  app.subscribe(
    (state) => [state.looking, state.presentation],
    () => queueMicrotask(place),
  ); // after the choice on the timeline
  const hide = () => {
    root.hidden = true;
    fill(root);
  };
  app.subscribe(
    (state) => [
      state.connection,
      state.ended,
      state.notice,
      state.problem,
      state.language,
      state.session,
      state.viewers > 1,
      state.broken,
    ],
    ([connection, , notice], before) => {
      clearTimeout(timer);
      const blocked = inTheWay(app);
      if (blocked) {
        if (connection === 'reconnecting' && before?.[0] !== 'reconnecting')
          timer = setTimeout(show, PATIENCE, blocked);
        else show(blocked);
        return;
      }
      const action = notice?.action ?? null;
      const left = notice ? notice.at + (action ? OFFERED : SHOWN) - performance.now() : 0;
      if (notice === null || left <= 0) {
        hide();
        return;
      }
      const act = () => {
        app.store.dispatch({type: 'set', notice: null}); // an action is offered once
        action?.act();
      };
      const offered = action && !(action.alone && app.state.viewers > 1);
      show({
        kind: notice.kind,
        words: say(notice.message),
        buttons: offered ? [button(say(action.message), act)] : [],
      });
      timer = setTimeout(hide, left);
    },
  );
}

/**
 * The faults with which the plant diverged, one text each.
 * @param {State} state
 */
function under({plant, faults}) {
  const sensors = new Set(plant?.channels.filter(({kind}) => kind === 'sensor').map(({name}) => name));
  const acting = faults.filter(({active, onChannel, subject}) => active && onChannel && !sensors.has(subject));
  return acting.map(
    ({subject, fault}) => `${called(subject, plant)}${'size' in fault ? ` = ${number(fault.size, 3)}` : ''}`,
  );
}

/**
 * Why the session cannot go on, with buttons that help; null: it can.
 * @param {App} app
 * @returns {Notice | null}
 */
function inTheWay(app) {
  const {state, act} = app;
  const {spec} = state;
  const anew = button(t('page.notice.new-session'), () => act.open(state.experiment));
  switch (state.connection) {
    case 'reconnecting':
      return {kind: 'lost', words: t('page.notice.reconnecting')};
    case 'full':
      return {kind: 'problem', words: t('page.notice.full'), buttons: [anew]};
    case 'failed':
      return {
        kind: 'problem',
        words: [h('b', {}, state.problem?.title ?? t('page.notice.failed')), ' ', state.problem?.detail ?? ''],
        buttons: [button(t('page.notice.new-session'), () => act.open(null))],
      };
    case 'ended':
      return {
        kind: 'problem',
        words: t('page.notice.session-ended'),
        buttons: [spec && button(t('page.notice.restart'), () => act.openSpec(spec, {t: app.samples.now})), anew],
      };
    default:
  }
  if (!state.ended) return null;
  if (state.spec?.truth?.record) return {kind: 'note', words: t('page.notice.record-end')};
  if (state.broken === null) return {kind: 'note', words: t('page.notice.horizon')};
  const [faults, at] = [under(state), timed(state.broken, spec?.horizon)];
  const before = Math.max(0, state.broken - Math.max(BEFORE * state.broken, 10 * state.record));
  return {
    kind: 'note',
    words: faults.length
      ? t('page.notice.plant-diverged-under', {t: at, faults})
      : t('page.notice.plant-diverged', {t: at}),
    buttons:
      state.role === 'control'
        ? [button(t('page.notice.back-to', {t: seconds(before, 0.1)}), () => act.seek(before))]
        : [],
  };
}
