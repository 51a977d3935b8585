// What can be seen? How small a fault may be, which faults this input does not tell apart, and an input that would.

import {post} from '../common/api.js';
import {fill, h, number} from '../common/dom.js';
import {badges, capital, spoken} from '../common/names.js';
import {badge, refusal} from '../widgets/controls.js';
import {small} from './fault-size.js';

const DECADES = [-3, 1.5]; // of level/needed, what the bar shows

/** @returns {{element: HTMLElement, show: () => void}} */
export function createSeen(app) {
  const body = h('div');
  const proposal = h('div', {class: 'proposal'});
  const along = h('div');
  const element = h(
    'div',
    {class: 'fold-out scroll', hidden: true, tabindex: 0, role: 'region'},
    body,
    proposal,
    along,
  );
  let shown = null;
  const show = () => {
    const {state, text} = app;
    element.setAttribute('aria-label', text.canSee);
    if (shown === state.diagnosis && element.lang === state.language) return;
    if (shown === null || element.lang !== state.language) offer();
    [shown, element.lang] = [state.diagnosis, state.language];
    fill(body, visible(app));
    proposal.hidden = !state.diagnosis?.excitation;
  };
  const offer = () =>
    fill(
      proposal,
      h(
        'button',
        {type: 'button', class: 'quiet control-only', title: app.text.proposeHint, onclick: ask},
        app.text.propose,
      ),
    );
  const ask = async (event) => {
    const {text, state} = app;
    event.currentTarget.disabled = true;
    fill(proposal, h('p', {class: 'soft'}, text.proposing));
    try {
      answer(await post(`/api/sessions/${state.session}/proposal`));
    } catch (error) {
      answer({input: null, text: error.message});
    }
  };
  const answer = (found) => {
    const {text, state} = app;
    const problem = h('p', {class: 'refused', role: 'alert'});
    const apply = async () => {
      try {
        await app.send({type: 'set-signal', name: found.input, signal: found.signal});
        fill(proposal, h('p', {class: 'soft'}, text.applied));
        setTimeout(() => {
          if (proposal.isConnected) offer();
        }, 6000);
      } catch (error) {
        refusal(problem, error, text);
      }
    };
    const words = spoken(text.said(found.text), state.plant, text);
    fill(
      proposal,
      h('p', {role: 'status'}, capital(words), text.stop),
      h(
        'div',
        {class: 'presses'},
        found.input && h('button', {type: 'button', class: 'press control-only', onclick: apply}, text.apply),
        h('button', {type: 'button', class: 'press quiet-press', onclick: offer}, text.dismiss),
      ),
      problem,
    );
  };
  app.subscribe(
    (state) => [state.session, state.language],
    () => {
      shown = null;
      offer();
      fill(along, trajectory(app));
    },
  );
  return {element, show};
}

/** Rank and condition along the trajectory of the experiment, when they are asked for. */
export function trajectory(app) {
  const {text} = app;
  const place = h('div', {class: 'trajectory'});
  const ask = async (event) => {
    event.currentTarget.disabled = true;
    try {
      const {spec, plant} = app.state;
      const found = await post('/api/observability', {...spec, observers: [], figures: [], commands: []});
      fill(
        place,
        h(
          'p',
          {},
          text.byEquations(found.rank ?? '–', found.size),
          ' ',
          capital(spoken(text.said(found.text), plant, text)),
          text.stop,
        ),
        h(
          'table',
          {class: 'seen'},
          h(
            'thead',
            {},
            h(
              'tr',
              {},
              [text.windowFrom(number(found.window, 3)), text.rank, text.condition].map((head) =>
                h('th', {scope: 'col'}, head),
              ),
            ),
          ),
          h(
            'tbody',
            {},
            found.t.map((t, k) =>
              h(
                'tr',
                {},
                h('td', {}, number(t, 4)),
                h('td', {}, `${found.ranks[k] ?? '–'} / ${found.size}`),
                h('td', {}, number(found.conditions[k], 2)),
              ),
            ),
          ),
        ),
        h('p', {class: 'soft small'}, capital(spoken(text.said(found.along), plant, text)), text.stop),
      );
      place.scrollIntoView({block: 'nearest'});
    } catch (error) {
      fill(place, h('p', {class: 'refused', role: 'alert'}, error.message));
    }
  };
  fill(place, h('button', {type: 'button', class: 'quiet', onclick: ask}, text.alongTrajectory));
  return place;
}

/** In words, as a bar, and channel by channel. */
export function visible(app) {
  const {diagnosis, plant} = app.state;
  const {text} = app;
  if (!diagnosis) return h('p', {class: 'soft'}, text.wait);
  if (!diagnosis.excitation) return h('p', {class: 'soft'}, spoken(text.said(diagnosis.note), plant, text));
  const {excitation, resolution} = diagnosis;
  const words = spoken(text.said(excitation.text), plant, text);
  return [
    h('p', {}, capital(words), text.stop),
    excitation.level !== null && bar(excitation, text),
    table(resolution, app),
  ];
}

/** The level against what is needed, on a logarithmic scale; both as the times by which a typical fault stands out. */
function bar({level, needed, window}, text) {
  const share = (value) =>
    Math.min(
      1,
      Math.max(0.01, (Math.log10(Math.max(value, 1e-300) / needed) - DECADES[0]) / (DECADES[1] - DECADES[0])),
    );
  const percent = (value) => `${(100 * share(value)).toFixed(1)}%`;
  const enough = level >= needed * (1 - 1e-9);
  return [
    h(
      'div',
      {
        class: `level${enough ? ' enough' : ''}`,
        role: 'img',
        'aria-label': text.levelOf(number(Math.sqrt(level), 2), number(Math.sqrt(needed), 2)),
      },
      h('span', {class: 'filled', style: `width:${percent(level)}`}),
      h('span', {class: 'needed', style: `left:${percent(needed)}`}),
    ),
    h(
      'p',
      {class: 'soft small'},
      text.levelOf(number(Math.sqrt(level), 2), number(Math.sqrt(needed), 2)),
      ' ',
      text.overLast(number(window, 3)),
    ),
  ];
}

/** Each channel: whether its fault can be told from the others now, and from what size on. */
function table(resolution, app) {
  const {state, text} = app;
  const short = badges(state.plant.channels);
  return h(
    'table',
    {class: 'seen'},
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('td'),
        h('th', {scope: 'col', title: text.smallestHint}, text.smallest),
        h('th', {scope: 'col'}, text.typical),
        h('td'),
      ),
    ),
    h(
      'tbody',
      {},
      resolution.map((one) => {
        const title = state.plant.channels.find(({name}) => name === one.channel)?.title;
        return h(
          'tr',
          {title: spoken(text.said(one.text), state.plant, text)},
          h('th', {scope: 'row'}, badge(short.get(one.channel)), h('span', {class: 'said'}, text.named(title))),
          h('td', {}, one.smallest === null ? '–' : small(one.smallest)),
          h('td', {}, small(one.typical)),
          h(
            'td',
            {class: 'words'},
            h('span', {class: `light ${one.identifiable && one.resolvable ? 'ok' : 'open'}`}),
            ' ',
            text[
              one.smallest === null
                ? 'notSeenNow'
                : !one.resolvable
                  ? 'underNoise'
                  : one.identifiable
                    ? 'canBeSeen'
                    : 'hardlySeen'
            ],
          ),
        );
      }),
    ),
  );
}
