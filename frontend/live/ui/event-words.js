// Events of the session as messages, in the order in which the log shows them.

import {number} from '../../common/dom.js';
import {called, plain} from '../../common/names.js';
import {amount} from '../../diagnosis/fault-size.js';
import {complete, differences} from '../../widgets/truth-differences.js';
import {say, t} from '../../i18n/words.js';

/** @import {Plant} from '../../pages/types.js' */
/** @import {Event, FaultInput, Gain} from '../types.js' */
/** @import {Message} from '../../i18n/render.js' */
/** @import * as service from '../../types/service.js' */

/** @typedef {{[gain: string]: string}} Signs   the symbols of the observers' gains */

/**
 * A line of the log.
 * @typedef {{event: Event, t: number, words: string, alarm: boolean, own: boolean}} Line
 */

const DRAGGED = 5; // s between two values of one slider that are shown as one

/**
 * Lines for the log, newest first by the time at which each event happened: an alarm, for example, is reported later
 * than it was raised. A gain, a noise level or an input that was dragged is one line. `signs`: the symbols of the
 * observers' gains.
 * @param {Event[]} log
 * @param {Plant | null} plant
 * @param {Signs} [signs]
 * @param {number} [most]
 * @returns {Line[]}
 */
export function lines(log, plant, signs = {}, most = 200) {
  const sorted = log
    .filter(({kind}) => kind !== 'substeps')
    .map((event, place) => ({event, place}))
    .sort((a, b) => b.event.t - a.event.t || b.place - a.place);
  const shown = [];
  for (const [place, {event}] of sorted.entries()) {
    if (shown.length >= most) break;
    const next = sorted[place - 1]?.event;
    if (dragged(event, next) || restarted(event, next)) continue;
    shown.push({
      event,
      t: event.t,
      words: restarted(sorted[place + 1]?.event, event)
        ? t('page.events.restarted', {label: event.subject})
        : words(event, plant, signs),
      alarm: event.kind === 'alarm' || event.kind === 'diverged',
      own: OWN.has(event.kind),
    });
  }
  return shown;
}

/** @param {Event} event */
const gainOf = ({value}) => /** @type {Partial<GainSet> | null} */ (value)?.gain;

/**
 * Whether a slider went on from a gain, a noise, a truth or an input to the next.
 * @param {Event} event
 * @param {Event | undefined} next
 */
const dragged = (event, next) =>
  ['gain', 'noise', 'truth', 'signal'].includes(event.kind) &&
  next?.kind === event.kind &&
  next.subject === event.subject &&
  gainOf(next) === gainOf(event) &&
  next.t - event.t < DRAGGED;

/**
 * Whether an observer was removed and added again in one row: it was restarted.
 * @param {Event | undefined} removed
 * @param {Event | undefined} added
 */
const restarted = (removed, added) =>
  removed?.kind === 'observer-removed' &&
  added?.kind === 'observer-added' &&
  removed.subject === added.subject &&
  removed.row === added.row;

const OWN = new Set([
  'inject',
  'clear',
  'gain',
  'signal',
  'noise',
  'truth',
  'observer-added',
  'observer-removed',
  'rewound',
  'reset',
]);

/**
 * The values of some kinds of events.
 * @typedef {{planned?: boolean}} Cleared
 * @typedef {{gain: string, value: Gain}} GainSet
 * @typedef {FaultInput & {[field: string]: unknown}} Injected
 */

/**
 * @typedef {object} Shown
 * @property {Event} event
 * @property {Plant | null} plant
 * @property {Signs} signs
 * @property {string} name   the name of its subject on the page
 */

/** @type {{[kind: string]: (shown: Shown) => string}} The words for each kind of event. */
const WORDS = {
  inject: ({event, name}) => injected(event, name),
  clear: ({event: {subject, value}, name}) => {
    const planned = /** @type {Cleared | null} */ (value)?.planned;
    if (subject) return planned ? t('page.events.clear-planned', {name}) : t('page.events.clear', {name});
    return planned ? t('page.events.clear-all-planned') : t('page.events.clear-all');
  },
  'fault-begins': ({name}) => t('page.events.fault-begins', {name}),
  'fault-ends': ({name}) => t('page.events.fault-ends', {name}),
  gain: ({event: {subject, value}, signs}) => {
    const {gain, value: size} = /** @type {GainSet} */ (value);
    return t('page.events.gain', {gain: signs[gain] ?? plain(gain), label: subject, size: valueText(size)});
  },
  signal: ({event, name}) => {
    const {shape} = /** @type {{shape?: Message}} */ (event.message.args);
    return shape ? t('page.events.signal-shape', {name, shape: say(shape)}) : t('page.events.signal', {name});
  },
  noise: ({event, name}) => t('page.events.noise', {name, size: valueText(event.value)}),
  truth: ({event, plant}) => {
    const parts = differences(complete(/** @type {service.Truth} */ (event.value)), plant);
    return parts.length > 0 ? t('page.events.truth', {parts}) : say(event.message);
  },
  'observer-added': ({event}) => t('page.events.observer-added', {label: event.subject}),
  'observer-removed': ({event}) => t('page.events.observer-removed', {label: event.subject}),
  alarm: ({event, plant}) => alarm(event, plant),
  'alarm-over': ({event, plant}) => t('page.events.alarm-over', {names: alarmNames(event, plant)}),
  diverged: ({event: {subject}}) =>
    subject ? t('page.events.diverged', {label: subject}) : t('page.events.plant-diverged'),
  rewound: ({event}) => t('page.events.rewound', {t: number(event.t, 4)}),
  reset: () => t('page.events.reset'),
};

/**
 * @param {Event} event
 * @param {Plant | null} plant
 * @param {Signs} signs
 */
function words(event, plant, signs) {
  const name = event.subject && called(event.subject, plant);
  return WORDS[event.kind]?.({event, plant, signs, name}) ?? say(event.message);
}

/**
 * The channel that an alarm names and those that explain the data equally well, or an output that no fault explains.
 * @param {Event} event
 * @param {Plant | null} plant
 */
function alarmNames({subject, value}, plant) {
  const {kind, channel, alternatives} = /** @type {service.Alarm} */ (value);
  return (kind === 'fault' ? [channel, ...alternatives] : [subject]).map((name) => called(name, plant));
}

/** @param {Event} event @param {Plant | null} plant */
function alarm(event, plant) {
  const value = /** @type {service.Alarm} */ (event.value);
  const names = alarmNames(event, plant);
  if (value.kind !== 'fault') return t('page.events.alarm-unexplained', {name: names[0]});
  if (names.length > 1) return t('page.events.alarm-ambiguous', {names});
  const channel = plant?.channels.find((one) => one.name === value.channel);
  const size =
    value.size === null
      ? '–'
      : amount({size: value.size, half: (Number(value.size_to) - Number(value.size_from)) / 2}, channel);
  return t('page.events.alarm', {name: names[0], size});
}

/** The field that tells most about a fault of a shape; any but a size is shown with its name. */
const MAIN = ['size', 'rate', 'intensity', 'value', 'std', 'probability', 'resolution', 'delay', 'values'];

/**
 * A fault that was injected: its shape, its main quantity, and when it starts if that is later.
 * @param {Event} event
 * @param {string} name
 */
function injected({value, t: at}, name) {
  const fault = /** @type {Injected} */ (value);
  const shape = t(`page.fault.shape.${fault.shape}`);
  const main = MAIN.find((one) => one in fault);
  const size = main && valueText(fault[main]);
  const event = !main
    ? t('page.events.inject-shape', {name, shape})
    : main === 'size'
      ? t('page.events.inject', {name, size, shape})
      : t('page.events.inject-quantity', {name, shape, quantity: t(`page.fault.field.${main}`), size});
  return fault.onset > 0 ? t('page.events.later', {event, t: (at + fault.onset).toFixed(1)}) : event;
}

/** @param {unknown} value @returns {string} */
function valueText(value) {
  if (Array.isArray(value)) return `(${value.map(valueText).join(', ')})`;
  return typeof value === 'number' ? number(value, 3) : String(value ?? '');
}
