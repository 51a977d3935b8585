// The assumptions of an observer: lights, which open to the list of its checks.

import {h, number} from '../common/dom.js';
import {say, t} from '../i18n/words.js';
import {chip as coloured} from './controls.js';
import {colourOf, repeats} from './line-style.js';
import {VERDICTS, verdictWords} from './verdicts.js';

/** @import * as service from '../types/service.js' */

/** @param {number} place */
const chip = (place) => coloured(colourOf(place), repeats(place));

/**
 * The lights of an observer's checks, which open to the list of them.
 * @param {service.ObserverSummary} one
 * @param {number} place
 */
export function assumptions(one, place) {
  const lights = one.checks.map((check) => h('span', {class: `light ${verdict(check)}`}));
  const rows = one.checks.map((check) =>
    h(
      'li',
      {},
      h('span', {class: `light ${verdict(check)}`}),
      h('b', {}, say(check.name)),
      ` ${verdictWords(check.verdict)}`,
      h(
        'span',
        {class: 'soft'},
        say(check.text),
        check.value === null ? '' : ` (${numbers(check)})`,
        check.source ? `. ${check.source}` : '',
      ),
    ),
  );
  /** @param {string} kind */
  const count = (kind) => one.checks.filter((check) => check.verdict === kind).length;
  const spoken = VERDICTS.filter(count)
    .map((kind) => `${count(kind)} ${verdictWords(kind)}`)
    .join(', ');
  return h(
    'details',
    {class: 'checks'},
    h(
      'summary',
      {},
      chip(place),
      h('b', {}, one.label),
      h('span', {class: 'lights', role: 'img', 'aria-label': spoken, title: spoken}, lights),
    ),
    one.title && h('p', {class: 'soft'}, say(one.title)),
    h('ul', {}, rows),
  );
}

/** @param {service.AssumptionCheck} check */
const verdict = (check) => ({holds: 'ok', fails: 'bad', 'cannot tell': 'open'})[check.verdict];

/**
 * The value of a check, with its threshold where it has one.
 * @param {service.AssumptionCheck} check
 */
const numbers = ({value, threshold}) =>
  threshold === null
    ? t('page.runs.check-value', {value: number(value)})
    : t('page.runs.check-value-threshold', {value: number(value), threshold: number(threshold)});
