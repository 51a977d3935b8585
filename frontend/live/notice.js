// What the page has to say about itself: a quiet line for some seconds or, while something stands in the way, until it is over.

import {fill, h, number} from '../dom.js';
import {called} from './panels/symbols.js';

const SHOWN = 6000; // ms
const OFFERED = 14_000; // ms, where there is something to click on
const PATIENCE = 700; // ms of a lost connection before it is worth a word

const button = (words, act) => h('button', {type: 'button', class: 'quiet', onclick: act}, words);

export function mountNotice(root, app) {
  let timer = 0;
  const show = ({kind, words, buttons = []}) => {
    root.className = kind;
    root.hidden = false;
    fill(root, h('span', {}, words), buttons);
  };
  const hide = () => {
    root.hidden = true;
    fill(root);
  };
  app.subscribe((state) => [state.connection, state.ended, state.told, state.problem, state.language, state.session, state.viewers > 1], ([connection, , told], before) => {
    clearTimeout(timer);
    const standing = inTheWay(app);
    if (standing) {
      if (connection === 'reconnecting' && before?.[0] !== 'reconnecting') timer = setTimeout(show, PATIENCE, standing);
      else show(standing);
      return;
    }
    const left = told ? told.at + (told.action ? OFFERED : SHOWN) - performance.now() : 0;
    if (left <= 0) {
      hide();
      return;
    }
    const act = () => {
      app.store.dispatch({type: 'set', told: null}); // what was taken is not offered again
      told.action.act();
    };
    const offered = told.action && !(told.action.alone && app.state.viewers > 1);
    show({kind: told.kind, words: told.text, buttons: offered ? [button(told.action.words, act)] : []});
    timer = setTimeout(hide, left);
  });
}

/** What stands in the way, with the ways on; null: nothing. */
function inTheWay(app) {
  const {state, text, act} = app;
  const anew = button(text.startNew, () => act.open(state.experiment));
  switch (state.connection) {
    case 'reconnecting': return {kind: 'lost', words: text.reconnecting};
    case 'full': return {kind: 'problem', words: text.full, buttons: [anew]};
    case 'failed': return {kind: 'problem', words: [h('b', {}, state.problem?.title ?? text.failed), ' ', state.problem?.detail ?? ''],
      buttons: [button(text.startNew, () => act.open(null))]};
    case 'ended': return {kind: 'problem', words: text.sessionEnded,
      buttons: [state.spec && button(text.startAgain, () => act.openSpec(state.spec, {t: app.samples.now})), anew]};
    default:
  }
  if (!state.ended) return null;
  const escaped = state.log.some((event) => event.kind === 'diverged' && !state.observers.some(({label}) => label === event.subject));
  const sensors = new Set(state.plant?.channels.filter(({kind}) => kind === 'sensor').map(({name}) => name));
  const acting = state.faults.filter(({active, onChannel, subject}) => active && onChannel && !sensors.has(subject));
  const names = acting.map(({subject, fault}) => `${called(subject, state.plant, text)}${typeof fault.size === 'number' ? ` = ${number(fault.size, 3)}` : ''}`);
  return {kind: 'note', words: escaped ? text.plantEscaped(names.join(', ')) : text.horizon};
}
