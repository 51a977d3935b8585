// Detectability: the smallest faults that are found, those that this input does not distinguish, and an input that
// would.

import {post, reason} from '../common/api.js';
import {fill, h, number} from '../common/dom.js';
import {badges, split, spoken} from '../common/names.js';
import {badge, refusal} from '../widgets/controls.js';
import {small} from './fault-size.js';
import {asSentence, named, t} from '../i18n/words.js';

/** @import {App, Diagnosis, DiagnosisState} from '../live/types.js' */
/** @import * as service from '../types/service.js' */

const DECADES = [-3, 1.5]; // of level/needed, the range of the bar

/**
 * @param {App} app
 * @returns {{element: HTMLElement, show: () => void}}
 */
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
  /** @type {Diagnosis | null} */
  let shown = null;
  const show = () => {
    const {state} = app;
    element.setAttribute('aria-label', t('page.diagnosis.detectability'));
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
        {type: 'button', class: 'quiet control-only', title: t('page.detectability.propose.hint'), onclick: ask},
        t('page.detectability.propose'),
      ),
    );
  /** @param {{currentTarget: HTMLButtonElement}} event */
  const ask = async ({currentTarget: button}) => {
    const {state} = app;
    button.disabled = true;
    fill(proposal, h('p', {class: 'soft'}, t('page.detectability.proposing')));
    try {
      answer(await post(`/api/sessions/${state.session}/proposal`));
    } catch (error) {
      answer({input: '', signal: null, text: {code: '', args: {}, text: reason(error).message}});
    }
  };
  /** @param {Pick<service.InputProposal, 'input' | 'signal' | 'text'>} found */
  const answer = (found) => {
    const {state} = app;
    const problem = h('p', {class: 'refused', role: 'alert'});
    const apply = async () => {
      if (!found.input || !found.signal) return;
      try {
        await app.send({type: 'set-signal', name: found.input, signal: found.signal});
        fill(proposal, h('p', {class: 'soft'}, t('page.detectability.applied')));
        setTimeout(() => {
          if (proposal.isConnected) offer();
        }, 6000);
      } catch (error) {
        refusal(problem, error);
      }
    };
    const words = spoken(found.text, state.plant);
    fill(
      proposal,
      h('p', {role: 'status'}, asSentence(words)),
      h(
        'div',
        {class: 'presses'},
        found.input &&
          h('button', {type: 'button', class: 'press control-only', onclick: apply}, t('page.action.apply')),
        h('button', {type: 'button', class: 'press quiet-press', onclick: offer}, t('page.action.close')),
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

/**
 * Rank and condition along the trajectory of the experiment, computed on request.
 * @param {{state: DiagnosisState}} app
 */
export function trajectory(app) {
  const place = h('div', {class: 'trajectory'});
  /** @param {{currentTarget: HTMLButtonElement}} event */
  const ask = async ({currentTarget: button}) => {
    button.disabled = true;
    try {
      const {spec, plant} = app.state;
      /** @type {service.Observability} */
      const observability = await post('/api/observability', {...spec, observers: [], figures: [], commands: []});
      fill(
        place,
        h(
          'p',
          {},
          t('page.detectability.structural-rank', {rank: observability.rank ?? '–', size: observability.size}),
          ' ',
          asSentence(spoken(observability.text, plant)),
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
              [
                t('page.detectability.window-from', {s: number(observability.window, 3)}),
                t('page.detectability.rank'),
                t('page.detectability.condition'),
              ].map((head) => h('th', {scope: 'col'}, head)),
            ),
          ),
          h(
            'tbody',
            {},
            observability.t.map((t, k) =>
              h(
                'tr',
                {},
                h('td', {}, number(t, 4)),
                h('td', {}, `${observability.ranks[k] ?? '–'} / ${observability.size}`),
                h('td', {}, number(observability.conditions[k], 2)),
              ),
            ),
          ),
        ),
        h('p', {class: 'soft small'}, asSentence(spoken(observability.along, plant))),
      );
      place.scrollIntoView({block: 'nearest'});
    } catch (error) {
      fill(place, h('p', {class: 'refused', role: 'alert'}, reason(error).message));
    }
  };
  fill(place, h('button', {type: 'button', class: 'quiet', onclick: ask}, t('page.detectability.trajectory')));
  return place;
}

/**
 * In words, as a bar, and channel by channel.
 * @param {{state: DiagnosisState}} app
 */
export function visible(app) {
  const {diagnosis, plant} = app.state;
  if (!diagnosis) return h('p', {class: 'soft'}, t('page.text.loading'));
  if (!diagnosis.excitation) return h('p', {class: 'soft'}, spoken(diagnosis.note, plant));
  const {excitation, resolution} = diagnosis;
  const words = spoken(excitation.text, plant);
  return [h('p', {}, asSentence(words)), excitation.level !== null && bar(excitation), table(resolution, app)];
}

/**
 * The level of excitation and the level that is needed, on a logarithmic scale; both as multiples of the noise by
 * which a typical fault stands out.
 * @param {service.Excitation} excitation
 */
function bar({level: found, needed, window}) {
  const level = found ?? 0;
  /** @param {number} value */
  const share = (value) =>
    Math.min(
      1,
      Math.max(0.01, (Math.log10(Math.max(value, 1e-300) / needed) - DECADES[0]) / (DECADES[1] - DECADES[0])),
    );
  /** @param {number} value */
  const percent = (value) => `${(100 * share(value)).toFixed(1)}%`;
  const enough = level >= needed * (1 - 1e-9);
  return [
    h(
      'div',
      {
        class: `level${enough ? ' enough' : ''}`,
        role: 'img',
        'aria-label': t('page.detectability.level', {
          level: number(Math.sqrt(level), 2),
          needed: number(Math.sqrt(needed), 2),
        }),
      },
      h('span', {class: 'filled', style: `width:${percent(level)}`}),
      h('span', {class: 'needed', style: `left:${percent(needed)}`}),
    ),
    h(
      'p',
      {class: 'soft small'},
      t('page.detectability.level', {level: number(Math.sqrt(level), 2), needed: number(Math.sqrt(needed), 2)}),
      ' ',
      t('page.detectability.window', {s: number(window, 3)}),
    ),
  ];
}

/**
 * Each channel: whether its fault can be distinguished from the others now, and from which size on.
 * @param {Diagnosis['resolution']} resolution
 * @param {{state: DiagnosisState}} app
 */
function table(resolution, app) {
  const {state} = app;
  const channels = state.plant?.channels ?? [];
  const short = badges(channels);
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
        h('th', {scope: 'col', title: t('page.detectability.smallest.hint')}, t('page.detectability.smallest')),
        h('th', {scope: 'col'}, t('page.detectability.typical')),
        h('td'),
      ),
    ),
    h(
      'tbody',
      {},
      resolution.map((one) => {
        const title = channels.find(({name}) => name === one.channel)?.title;
        return h(
          'tr',
          {title: spoken(one.text, state.plant)},
          h(
            'th',
            {scope: 'row'},
            badge(short.get(one.channel) ?? split(one.channel)),
            h('span', {class: 'visually-hidden'}, named(title)),
          ),
          h('td', {}, one.smallest === null ? '–' : small(one.smallest)),
          h('td', {}, small(one.typical)),
          h(
            'td',
            {class: 'words'},
            h('span', {class: `light ${one.identifiable && one.resolvable ? 'ok' : 'open'}`}),
            ' ',
            resolvedWords(one),
          ),
        );
      }),
    ),
  );
}

/**
 * Whether the fault of a channel can be distinguished now, in words.
 * @param {Diagnosis['resolution'][number]} resolution
 */
function resolvedWords({smallest, resolvable, identifiable}) {
  if (smallest === null) return t('page.diagnosis.not-identifiable');
  if (!resolvable) return t('page.detectability.below-noise');
  return identifiable ? t('page.detectability.distinguishable') : t('page.detectability.hardly-distinguishable');
}
