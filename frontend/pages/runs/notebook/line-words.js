// The words of a line: its name, what was changed, and when.

import {h, number} from '../../../common/dom.js';
import {plain} from '../../../common/names.js';
import {write} from '../address.js';
import {hasWords, language, t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Argument} from '../../../i18n/render.js' */

const SHOWN = 4;
const SETTABLE = /^(?!plant$|record$|commands$)[^#]+$/;

/** The name of a run: its owner's, the record's, else the beginning of its id. @param {service.RunLine} line */
export const nameOf = (line) => line.name || line.record || `r-${line.id.slice(0, 4)}`;

/**
 * The label of a change, names of symbols in Greek letters.
 * @param {service.Text} label
 * @returns {string}
 */
export function labelOf(label) {
  const {code, args} = /** @type {{code: string, args: Record<string, Argument>}} */ (greek(label));
  return hasWords(code) ? t(code, args) : label.text;
}

/** @param {unknown} message @returns {unknown} */
function greek(message) {
  if (!message || typeof message !== 'object' || !('args' in message)) return message;
  const args = Object.entries(/** @type {object} */ (message.args)).map(([key, value]) => [
    key,
    key === 'name' && typeof value === 'string' ? plain(value) : greek(value),
  ]);
  return {...message, args: Object.fromEntries(args)};
}

/** A value of a setting. @param {service.RunChange['to']} value */
export const valueOf = (value) => (typeof value === 'number' ? number(value) : value === null ? '' : value);

/**
 * What was changed, as a phrase: old values soft, new ones in ink.
 * @param {service.RunLine} line
 */
export function changesOf({changes, plant, kind}) {
  if (kind === 'record') return h('span', {class: 'changes'}, plant);
  if (changes === null)
    return h('span', {class: 'changes soft'}, t('page.notebook.own-experiment', {plant: plant ?? ''}));
  if (!changes.length) return h('span', {class: 'changes soft'}, t('page.notebook.nothing-changed'));
  const more = changes.length - SHOWN;
  return h(
    'span',
    {class: 'changes'},
    changes.slice(0, SHOWN).map((change, place) => [place > 0 && ', ', phrase(change)]),
    more > 0 && h('span', {class: 'soft'}, ', ', t('page.notebook.more-changes', {n: more})),
  );
}

/** @param {service.RunChange} change */
function phrase({label, from, to}) {
  const words = labelOf(label);
  if (to === null) return [h('span', {class: 'soft'}, '− '), words];
  if (from === null && typeof to === 'string') return [h('span', {class: 'soft'}, '+ '), words];
  return [
    `${words} `,
    from !== null && h('span', {class: 'soft'}, `${valueOf(from)} → `),
    h('span', {class: 'after'}, valueOf(to)),
  ];
}

/**
 * The address that opens a run: with its changes in the form where the form can show all of them.
 * @param {service.RunLine} line
 */
export function addressOfRun({id, experiment, changes}) {
  const settable = changes?.every(({path, to}) => typeof to === 'number' && SETTABLE.test(path));
  if (!experiment || !changes || !settable) return write({experiment: null, run: id});
  return write({experiment, changes: Object.fromEntries(changes.map(({path, to}) => [path, to])), run: id});
}

/**
 * When a run was made, as one says it today.
 * @param {string} created
 * @param {Date} [today]
 */
export function whenOf(created, today = new Date()) {
  const at = new Date(created);
  /** @param {Date} day */
  const days = (day) => Math.floor((day.getTime() - day.getTimezoneOffset() * 60000) / 86400000);
  const age = days(today) - days(at);
  const time = at.toLocaleTimeString(language(), {hour: '2-digit', minute: '2-digit', hour12: false});
  if (age === 0) return t('page.notebook.today', {time});
  if (age === 1) return t('page.notebook.yesterday');
  const year = at.getFullYear() === today.getFullYear() ? {} : {year: /** @type {const} */ ('numeric')};
  return at.toLocaleDateString(language() === 'en' ? 'en-GB' : language(), {day: 'numeric', month: 'short', ...year});
}
