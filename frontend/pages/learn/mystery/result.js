// The result of a mystery: who was right, the strip with both marks, points and reasons, and ways on.

import {fill, h, number, symbol} from '../../../common/dom.js';
import * as permalink from '../../../live/state/permalink.js';
import {named, say, t} from '../../../i18n/words.js';
import {Strip} from './strip.js';
import {roughness} from './strips.js';
import {roundOf} from './place.js';
import {digits} from './times.js';

/** @import {Child} from '../../../types/dom.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {Game} from './game.js' */
/** @import {Area, Line} from './strip.js' */

/** @param {HTMLElement} main @param {Game} game */
export function drawResult(main, game) {
  const {mystery, solution} = game;
  if (!solution) return;
  const {score, detector_score: other} = solution;
  fill(
    main,
    h(
      'section',
      {class: 'card mystery-result', 'aria-labelledby': 'result-title'},
      h('p', {class: 'soft'}, t('page.mystery.round', {n: roundOf(game.name), title: named(mystery.title)})),
      h('h1', {id: 'result-title', tabindex: -1}, t('page.mystery.result', {you: score.total, detector: other.total})),
      h('p', {class: 'sentence'}, sentences(game, solution)),
      picture(game, solution),
      table(game, solution),
      actions(game, solution),
    ),
  );
}

/** @param {Game} game @param {string} channel */
const title = (game, channel) => named(game.mystery.choices.find((one) => one.channel === channel)?.title ?? channel);

/** @param {Game} game @param {readonly string[]} channels */
const titles = (game, channels) => channels.map((channel) => title(game, channel));

/** Channels that fit until the end beside the true one. @param {service.ChallengeTruth} truth */
const lookalikes = (truth) =>
  truth.rivals.filter(({channel, until}) => channel !== '' && until === null).map(({channel}) => channel);

/** The time from which it could be told. @param {service.ChallengeTruth} truth */
const toldFrom = ({fault, rivals, end}) =>
  fault === null ? end : Math.max(fault.onset, ...rivals.map(({until}) => until ?? 0));

/** @param {Game} game @param {service.MysterySolution} solution */
function sentences(game, {truth, answer, score, detector, detector_score: other}) {
  const {fault, end} = truth;
  const alike = lookalikes(truth);
  const parts = [];
  if (fault === null) parts.push(t('page.mystery.was-nothing'));
  else {
    const args = {name: title(game, fault.channel), t: digits(fault.onset, end)};
    parts.push(fault.duration === null ? t('page.mystery.was-sudden', args) : t('page.mystery.was-gradual', args));
  }
  if (alike.length) parts.push(t('page.mystery.nobody-could', {names: titles(game, alike)}));
  const [mine, its] = [score.points[0].points, other.points[0].points];
  if (mine > 0 && its > 0) {
    const ahead = (detector?.at ?? end) - answer.at;
    if (fault === null || Math.abs(ahead) < 1e-9 * end) parts.push(t('page.mystery.both'));
    else if (ahead > 0) parts.push(t('page.mystery.both-you', {seconds: number(ahead, 3)}));
    else parts.push(t('page.mystery.both-detector', {seconds: number(-ahead, 3)}));
  } else if (mine > 0) parts.push(t('page.mystery.only-you'));
  else if (its > 0) parts.push(t('page.mystery.only-detector'));
  else parts.push(t('page.mystery.neither'));
  if (fault && mine > 0 && answer.channel && answer.onset !== null) {
    const off = answer.onset - fault.onset;
    if (Math.abs(off) < game.mystery.record / 2) parts.push(t('page.mystery.dated'));
    else if (off > 0) parts.push(t('page.mystery.dated-late', {seconds: number(off, 3)}));
    else parts.push(t('page.mystery.dated-early', {seconds: number(-off, 3)}));
  }
  return parts.join(game.language === 'zh' ? '' : ' ');
}

/**
 * The strip that shows most, with the fault and both marks.
 * @param {Game} game
 * @param {service.MysterySolution} solution
 */
function picture(game, {truth, answer, detector}) {
  const {mystery} = game;
  const {fault, end} = truth;
  const residuals = mystery.columns.filter(({of, observer}) => of === 'residual' && observer === '');
  const column = residuals.reduce((best, one) => (loudness(one) > loudness(best) ? one : best));
  const told = toldFrom(truth);
  const words = t('page.mystery.difference');
  const unit = column.unit ? `${words}, ${column.unit}` : words;
  const strip = new Strip({
    label: [
      h('span', {class: 'strip-sign', lang: 'en'}, symbol(column.subject), ' − ', symbol(column.subject, true)),
      h('span', {class: 'soft'}, unit),
    ],
    words: `${column.subject}: ${unit}`,
    end,
    record: mystery.record,
    height: 190,
    least: 2.5 * roughness(column.values),
    axis: true,
  });
  /** @type {Area[]} */
  const areas = [];
  /** @type {Line[]} */
  const lines = [];
  if (fault) {
    areas.push({from: fault.onset, to: end, look: 'fault'}, {from: fault.onset, to: told, look: 'untold'});
    const began = t('page.mystery.began', {t: digits(fault.onset, end)});
    lines.push({t: fault.onset, look: 'truth', words: began, row: 0, before: true});
  }
  if (detector && detector.verdict !== 'none')
    lines.push({t: detector.at, look: 'detector', words: t('page.mystery.detector'), row: 1});
  if (answer.verdict !== 'none')
    lines.push({t: answer.at, look: 'you', words: t('page.mystery.you-at', {t: digits(answer.at, end)}), row: 2});
  strip.draw({curves: [{values: column.values, look: 'difference'}], shown: end, lines, areas});
  const looked = truth.rivals
    .filter(({channel, until}) => channel !== '' && until !== null && until >= told - 1e-9 && until > truth.end / 1e6)
    .map(({channel}) => channel);
  return h(
    'figure',
    {class: 'mystery-figure'},
    strip.element,
    fault &&
      told > fault.onset &&
      h(
        'figcaption',
        {class: 'soft'},
        h('span', {class: 'key untold', 'aria-hidden': 'true'}),
        looked.length
          ? t('page.mystery.untold', {
              from: digits(fault.onset, end),
              to: digits(told, end),
              names: titles(game, [fault.channel, ...looked]),
            })
          : t('page.mystery.unseen', {from: digits(fault.onset, end), to: digits(told, end)}),
      ),
  );
}

/** How far a difference goes beyond its noise. @param {service.MysteryColumn} column */
const loudness = ({values}) => {
  const most = values.reduce((/** @type {number} */ so, value) => Math.max(so, Math.abs(value ?? 0)), 0);
  return most / roughness(values);
};

/** @param {Game} game @param {service.MysterySolution} solution */
function table(game, {truth, answer, score, detector, detector_score: other}) {
  const {end, fault} = truth;
  const right = fault ? [fault.channel, ...lookalikes(truth)] : [];
  const unit = game.mystery.choices.find(({channel}) => channel === fault?.channel)?.unit ?? '';
  /** @param {number | null | undefined} size */
  const size = (size) => (size === null || size === undefined ? '–' : `${number(size, 3)} ${unit}`.trim());
  /** @param {service.ChallengeAnswer | null} one */
  const which = (one) => {
    if (one === null) return t('page.mystery.no-answer');
    if (one.verdict === 'none') return t('page.mystery.none');
    if (one.verdict === 'cannot-be-told') return t('page.mystery.one-of', {names: titles(game, one.alike)});
    return title(game, one.channel ?? '');
  };
  /** @param {service.ChallengeAnswer | null} one */
  const blamed = (one) =>
    one?.accused.length
      ? titles(
          game,
          one.accused.map(({channel}) => channel),
        ).join(', ')
      : t('page.mystery.nobody');
  /** @param {service.ChallengeAnswer | null} one */
  const mySize = (one) => (one?.channel === fault?.channel ? size(one?.size) : '–');
  /** @type {[string, Child, Child, Child][]} */
  const rows = [
    [
      t('page.mystery.points-name'),
      fault
        ? right.length > 1
          ? t('page.mystery.one-of', {names: titles(game, right)})
          : title(game, fault.channel)
        : t('page.mystery.none'),
      which(answer),
      which(detector),
    ],
    [t('page.mystery.points-size'), fault ? size(fault.size) : '–', mySize(answer), mySize(detector)],
    [
      t('page.mystery.points-soon'),
      fault ? t('page.mystery.told-from', {t: digits(toldFrom(truth), end)}) : '–',
      answer.verdict === 'none' ? '–' : t('page.mystery.at', {t: digits(answer.at, end)}),
      detector && detector.verdict !== 'none' ? t('page.mystery.at', {t: digits(detector.at, end)}) : '–',
    ],
    [t('page.mystery.points-accused'), '', blamed(answer), blamed(detector)],
  ];
  /** @param {service.Points} one @param {Child} words @param {string} who */
  const cells = (one, words, who) => [
    h('td', {'data-who': who}, words, h('span', {class: 'why'}, say(one.why))),
    h('td', {class: 'points'}, one.points),
  ];
  const head = [
    '',
    t('page.mystery.truth'),
    t('page.mystery.you'),
    t('page.mystery.points'),
    t('page.mystery.detector-title'),
    t('page.mystery.points'),
  ];
  return h(
    'table',
    {class: 'mystery-table'},
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        head.map((words) => (words ? h('th', {scope: 'col'}, words) : h('td', {}))),
      ),
    ),
    h(
      'tbody',
      {},
      rows.map(([words, true_, mine, its], at) =>
        h(
          'tr',
          {},
          h('th', {scope: 'row'}, words),
          h('td', {'data-who': t('page.mystery.truth')}, true_),
          cells(score.points[at], mine, t('page.mystery.you')),
          cells(other.points[at], its, t('page.mystery.detector-title')),
        ),
      ),
    ),
    h(
      'tfoot',
      {},
      h(
        'tr',
        {},
        h('th', {scope: 'row'}, t('page.mystery.together')),
        h('td', {}),
        h('td', {'data-who': t('page.mystery.you')}),
        h('td', {class: 'points'}, score.total),
        h('td', {'data-who': t('page.mystery.detector-title')}),
        h('td', {class: 'points'}, other.total),
      ),
    ),
  );
}

/** @param {Game} game @param {service.MysterySolution} solution */
function actions(game, {experiment}) {
  const copied = h('span', {class: 'soft', role: 'status'});
  const live = async () => {
    const spec = /** @type {import('../../../live/types.js').Experiment} */ (/** @type {unknown} */ (experiment));
    location.href = `/${await permalink.write({spec, t: 0, experiment: null, base: null})}`;
  };
  const share = async () => {
    try {
      await navigator.clipboard.writeText(location.href);
      copied.textContent = t('page.mystery.copied');
    } catch {
      copied.textContent = location.href;
    }
  };
  return h(
    'div',
    {class: 'mystery-ways'},
    h('button', {type: 'button', class: 'run', onclick: () => game.another()}, t('page.mystery.another')),
    h('button', {type: 'button', class: 'quiet', onclick: () => game.again()}, t('page.mystery.again')),
    h('button', {type: 'button', class: 'quiet', onclick: live}, t('page.mystery.in-live')),
    h('a', {class: 'quiet', href: '/learn/'}, t('page.mystery.to-course')),
    h('span', {class: 'grow'}),
    copied,
    h('button', {type: 'button', class: 'link', onclick: share}, t('page.mystery.challenge')),
  );
}
