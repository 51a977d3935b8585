// What the page has to say about itself: a quiet line at its foot for some seconds, or, while something stands in the way, until it is over.

import {fill, h} from '../dom.js';

const SHOWN = 6000; // ms
const PATIENCE = 700; // ms of a lost connection before it is worth a word

export function mountNotice(root, app) {
  let timer = 0;
  let waiting = 0;

  function show(kind, words, ...buttons) {
    root.className = kind;
    root.hidden = false;
    fill(root, h('span', {}, words), buttons);
  }

  const hide = () => {
    root.hidden = true;
    fill(root);
  };
  const button = (words, act) => h('button', {type: 'button', class: 'quiet', onclick: act}, words);

  function standing() {
    const {state, text} = app;
    const ways = {
      reconnecting: () => show('lost', text.reconnecting),
      ended: () => show('problem', text.sessionEnded, state.spec && button(text.startAgain, () => app.act.openSpec(state.spec, {t: app.samples.now})),
        button(text.startNew, () => app.act.open(state.experiment))),
      full: () => show('problem', text.full, button(text.startNew, () => app.act.open(state.experiment))),
      failed: () => show('problem', [h('b', {}, state.problem?.title ?? text.failed), ' ', state.problem?.detail ?? ''], button(text.startNew, () => app.act.open(null))),
    };
    if (ways[state.connection]) return ways[state.connection];
    const fallen = state.ended && state.log.findLast((event) => event.kind === 'diverged' && !state.observers.some(({label}) => label === event.subject));
    if (state.ended) return () => show('note', fallen ? text.plantEscaped : text.horizon);
    return null;
  }

  app.subscribe((state) => [state.connection, state.ended, state.told, state.problem, state.language, state.session], ([connection, , told], before) => {
    clearTimeout(waiting);
    clearTimeout(timer);
    const way = standing();
    if (way) {
      if (connection === 'reconnecting' && before?.[0] !== 'reconnecting') waiting = setTimeout(way, PATIENCE);
      else way();
      return;
    }
    const left = told ? told.at + SHOWN - performance.now() : 0;
    if (left <= 0) {
      hide();
      return;
    }
    show(told.kind, told.text);
    timer = setTimeout(hide, left);
  });
}
