// Findings in words: the sentence, and one line each, of a session or a run.

import {h} from '../common/dom.js';
import {badges, called, capital, spoken, split, symbolic} from '../common/names.js';
import {badge, seconds, took} from '../widgets/controls.js';
import {amount, resolutionOf, small} from './fault-size.js';
import {named, say, t} from '../i18n/words.js';

/** @import {Finding} from './findings.js' */
/** @import {Channel, DiagnosisState, FaultState, Plant} from '../live/types.js' */
/** @import {Argument, Message} from '../i18n/render.js' */
/** @import * as service from '../types/service.js' */

/** @typedef {{[name: string]: unknown}} Args */

/**
 * The arguments of the messages that the page words itself.
 * @typedef {{name: string, size: number | null, half: number | null}} AmountArgs
 * @typedef {{t: number}} TimeArgs
 */

/** Arguments that are names of channels or outputs. */
const NAMES = new Set(['name', 'names', 'other']);

/**
 * The summary in the page's language, with symbols for names and sizes as the panels write them.
 * @param {service.Text} summary
 * @param {{state: DiagnosisState}} app
 */
export const summarySentence = (summary, {state}) => capital(t(summary.code, spokenArgs(summary.args, state)));

/**
 * @param {Args} args
 * @param {DiagnosisState} state
 * @returns {Record<string, Argument>}
 */
const spokenArgs = (args, state) =>
  Object.fromEntries(Object.entries(args).map(([name, value]) => [name, spokenArg(name, value, state)]));

/**
 * An argument as the page says it: names with their symbols, sizes with the channel's digits, times with the session's.
 * @param {string} name
 * @param {unknown} value
 * @param {DiagnosisState} state
 * @returns {Argument}
 */
function spokenArg(name, value, state) {
  const {plant, spec} = state;
  if (Array.isArray(value)) return value.map((one) => spokenArg(name, one, state));
  if (NAMES.has(name)) return called(String(value), plant);
  if (name === 'note') return spoken(say(/** @type {Message | string | null} */ (value)), plant);
  if (value === null || typeof value !== 'object') return /** @type {Argument} */ (value);
  const {code, args} = /** @type {{code: string, args: Args}} */ (value);
  if (code === 'diagnosis.amount') {
    const amountArgs = /** @type {AmountArgs} */ (args);
    return amount(
      amountArgs,
      plant?.channels.find((one) => one.name === amountArgs.name),
    );
  }
  if (code === 'diagnosis.time') return seconds(/** @type {TimeArgs} */ (args).t, spec?.horizon);
  if (code === 'diagnosis.duration') return took(/** @type {TimeArgs} */ (args).t);
  // a channel whose name is a word has a title that says its kind
  if (code.startsWith('diagnosis.fault.') && !symbolic(String(args.name))) return called(String(args.name), plant);
  return {code, args: spokenArgs(args, state)};
}

/**
 * One finding: the size with its interval, and its story in a line.
 * @param {Finding} one
 * @param {{state: DiagnosisState}} app
 */
export function line(one, app) {
  const {state} = app;
  const {alarm, verdict} = one;
  const channels = state.plant?.channels ?? [];
  const channel = channels.find(({name}) => name === one.subject);
  const short = badges(channels);
  const acting = new Set(
    state.faults.filter((fault) => fault.active && fault.onChannel === one.onChannel).map((fault) => fault.subject),
  );
  const chips = one.subjects.map((name, place) => [
    place > 0 && h('small', {}, t('page.diagnosis.or')),
    badge(short.get(name) ?? split(name), {square: !one.onChannel, lit: verdict !== 'past' && acting.has(name)}),
  ]);
  const shown =
    alarm?.size === null || alarm?.size === undefined
      ? verdict === 'undetected'
        ? ''
        : t('page.diagnosis.not-in-model')
      : amount(alarm, channel);
  const end = {
    found: () =>
      one.delay !== null
        ? [t('page.diagnosis.found-in'), ' ', h('b', {}, took(one.delay))]
        : one.again
          ? t('page.diagnosis.alarm-was-on')
          : null,
    misattributed: () => h('span', {class: 'alarm'}, t('page.diagnosis.other-fault')),
    false: () => h('span', {class: 'alarm'}, t('page.diagnosis.no-fault')),
    over: () => t('page.diagnosis.ended'),
    undetected: () => (one.unjudged ? t('page.diagnosis.not-judged') : t('page.diagnosis.not-found')),
    past: () => t('page.diagnosis.cleared'),
  }[verdict]();
  return h(
    'div',
    {class: `finding ${verdict}${one.subjects.length > 1 ? ' either' : ''}`},
    h('span', {class: 'chips'}, chips),
    h(
      'div',
      {},
      h(
        'div',
        {class: 'line'},
        h(
          'span',
          {class: 'amount'},
          h('span', {class: 'value'}, shown),
          h('small', {}, alarm?.explained && channel?.unit),
        ),
        end && h('span', {class: 'sub'}, end),
      ),
      h('div', {class: 'sub'}, story(one, channel, app).filter(Boolean).join(' · ')),
    ),
  );
}

/**
 * The subject, its times, and the remarks.
 * @param {Finding} finding
 * @param {Channel | undefined} channel
 * @param {{state: DiagnosisState}} app
 * @returns {(string | false)[]}
 */
function story({verdict, subjects, onChannel, alarm, fault}, channel, app) {
  const {state} = app;
  const horizon = state.spec?.horizon;
  const title =
    subjects.length > 1
      ? t('page.diagnosis.if', {name: called(subjects[0], state.plant)})
      : onChannel
        ? named(channel?.title) || called(subjects[0], state.plant)
        : capital(called(subjects[0], state.plant));
  if (fault) return [title, t('page.diagnosis.since', {t: seconds(fault.onset, horizon)}), reason(fault, state)];
  if (!alarm) return [title];
  if (verdict === 'past' && alarm.over !== null)
    return [title, `${seconds(alarm.onset, horizon)} – ${seconds(alarm.over, horizon)}`];
  const [from, to] = [alarm.from, alarm.to].map((t) => seconds(t, horizon));
  return [
    title,
    from === to
      ? t('page.diagnosis.since', {t: from})
      : t('page.diagnosis.began', {from: from.replace(/\s?s$/u, ''), to}),
    !onChannel && t('page.diagnosis.suspect-sensor'),
  ];
}

/**
 * Why a fault may not be found.
 * @param {FaultState} fault
 * @param {DiagnosisState} state
 */
function reason(fault, {diagnosis}) {
  const known = resolutionOf(fault.subject, diagnosis);
  if (!fault.onChannel || !known) return '';
  if (known.smallest === null) return t('page.diagnosis.not-identifiable');
  const size = 'size' in fault.fault ? fault.fault.size : Infinity;
  return Math.abs(size) < known.smallest ? t('page.diagnosis.too-small', {size: small(known.smallest)}) : '';
}
