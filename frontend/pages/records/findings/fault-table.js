// The table of faults: one row each, with the other explanations in the same row and reservations below.

import {h, number} from '../../../common/dom.js';
import {badges, capital, split} from '../../../common/names.js';
import {named, say, t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {badge} from '../../../widgets/controls.js';
import {withInterval} from '../numbers.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Plant} from '../types.js' */
/** @typedef {service.FaultCandidate} Candidate */

/** @type {[string, string]} badge of a fault that the plant has no channel for */
const ADDED = ['+', ''];

/**
 * @param {readonly service.RecordFault[]} faults
 * @param {Plant} plant
 */
export function faultTable(faults, plant) {
  if (faults.length === 0) return null;
  const short = badges(plant.channels);
  const heads = ['fault', 'shape', 'began', 'noticed', 'size', 'rate', 'else'].map((key) =>
    h('th', {scope: 'col', class: key}, t(`page.records.fault.${key}`)),
  );
  return h(
    'div',
    {class: 'wide', tabindex: 0, role: 'region', 'aria-label': t('page.records.faults')},
    h(
      'table',
      {class: 'faults'},
      h('thead', {}, h('tr', {}, heads)),
      h(
        'tbody',
        {},
        faults.map((one) => row(one, short, plant)),
      ),
    ),
  );
}

/**
 * A cell that says its column on narrow screens.
 * @param {string} key
 * @param {...import('../../../types/dom.js').Child} content
 */
const cell = (key, ...content) =>
  h('td', {class: key, 'data-title': t(`page.records.fault.${key}`)}, h('div', {}, content));

/**
 * The title of a candidate's channel, in the page's language; of a fault that the plant lacks as the service names it.
 * @param {Pick<Candidate, 'channel' | 'title'>} candidate
 * @param {Plant} plant
 */
export const titleOf = ({channel, title}, plant) =>
  named(plant.channels.find((one) => one.name === channel)?.title) || say(title) || channel;

/**
 * A sentence about faults with the titles of their channels in the page's language: the service writes them in English.
 * @template T
 * @param {T} message   or a part of one
 * @param {readonly service.RecordFault[]} faults
 * @param {Plant} plant
 * @returns {T}
 */
export function withTitles(message, faults, plant) {
  const titles = new Map(
    faults
      .flatMap(({best, alternatives}) => [best, ...alternatives])
      .filter(({channel, title}) => channel && !title.code)
      .map((one) => [one.title.text, titleOf(one, plant)]),
  );
  /** @param {unknown} part @returns {unknown} */
  const within = (part) => {
    if (Array.isArray(part)) return part.map(within);
    if (part === null || typeof part !== 'object') return part;
    const entries = Object.entries(part).map(([key, value]) => [
      key,
      key === 'title' && typeof value === 'string' ? (titles.get(value) ?? value) : within(value),
    ]);
    return Object.fromEntries(entries);
  };
  return /** @type {T} */ (within(message));
}

/** @param {service.RecordFault} fault @param {ReturnType<typeof badges>} short @param {Plant} plant */
function row({id, best, alternatives, alarm, ended, note}, short, plant) {
  const others = alternatives.map((one) => alternative(one, plant));
  return h(
    'tr',
    {id},
    h(
      'td',
      {class: 'fault'},
      h(
        'span',
        {class: 'fault-name'},
        badge(best.channel ? (short.get(best.channel) ?? split(best.channel)) : ADDED),
        h('b', {}, capital(titleOf(best, plant))),
      ),
      note && h('p', {class: 'reservation'}, sentence(note)),
    ),
    cell('shape', t(`page.records.shape.${best.shape}`)),
    cell(
      'began',
      `${withInterval(best.onset)}\u202fs`,
      ended !== null && h('small', {}, t('page.records.fault.ended', {t: number(ended, 5)})),
    ),
    cell('noticed', `${number(alarm, 5)}\u202fs`),
    cell('size', size(best)),
    cell('rate', best.rate === 0 ? '–' : `${number(best.rate, 3)}\u202f${best.unit ? `${best.unit}/s` : '1/s'}`),
    cell('else', others.length ? h('ul', {class: 'others'}, others) : t('page.records.fault.nothing-else')),
  );
}

/** The size at the end, or the bound that it has reached. @param {Candidate} candidate */
export const size = ({size: interval, bound, unit}) =>
  bound !== null
    ? h('b', {}, t('page.records.fault.at-bound', {bound: number(bound), unit}))
    : [h('b', {}, withInterval(interval)), unit && `\u202f${unit}`];

/** The same as plain text. @param {Pick<Candidate, 'size' | 'bound' | 'unit'>} candidate */
const sizeText = ({size: interval, bound, unit}) =>
  bound !== null
    ? t('page.records.fault.at-bound', {bound: number(bound), unit})
    : withInterval(interval) + (unit ? `\u202f${unit}` : '');

/** @param {Candidate} candidate @param {Plant} plant */
const alternative = ({title, channel, unit, size: interval, bound, separable, behind}, plant) =>
  h(
    'li',
    {class: separable ? 'less-likely' : 'inseparable'},
    `${titleOf({channel, title}, plant)}: ${sizeText({size: interval, bound, unit})}`,
    ' ',
    h(
      'small',
      {},
      separable ? t('page.records.fault.worse', {behind: number(behind, 2)}) : t('page.records.fault.inseparable'),
    ),
  );
