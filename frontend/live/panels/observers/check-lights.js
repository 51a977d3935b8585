// The lights of an observer's assumptions, and the list that they open to.

import {fill, h, number} from '../../../common/dom.js';
import {VERDICTS, verdictWords} from '../../../widgets/verdicts.js';
import {say, t} from '../../../i18n/words.js';

/** @import {Check} from '../../types.js' */

/** @type {{[verdict: string]: string}} */
const MARK = {holds: 'ok', fails: 'bad'};

/** @type {WeakMap<HTMLElement, Check[] | null>} the checks that a list shows */
const shown = new WeakMap();

/**
 * Lights, one a check, and the list that they open to.
 * @param {HTMLElement} lights
 * @param {HTMLElement} list
 * @param {Check[]} found
 * @param {((gains: NonNullable<Check['gains']>) => void) | null} take
 *   puts the gains that a check proposes into the observer; null while the list is closed
 */
export function showLights(lights, list, found, take) {
  /** @param {string} verdict */
  const count = (verdict) => found.filter((check) => check.verdict === verdict).length;
  const verdicts = VERDICTS.filter(count).map((verdict) => `${count(verdict)} ${verdictWords(verdict)}`);
  const spoken = t('page.observers.assumption-lights', {verdicts});
  fill(
    lights,
    found.map((check) => h('span', {class: `light ${MARK[check.verdict] ?? 'open'}`})),
  );
  lights.hidden = found.length === 0;
  lights.title = spoken;
  lights.setAttribute('aria-label', spoken);
  const wanted = take ? found : null;
  if (shown.get(list) === wanted) return;
  shown.set(list, wanted);
  if (!take) {
    fill(list);
    return;
  }
  fill(
    list,
    found.map((check) =>
      h(
        'li',
        {},
        h('span', {class: `light ${MARK[check.verdict] ?? 'open'}`}),
        h('b', {}, say(check.name)),
        ` ${verdictWords(check.verdict)}`,
        check.value === null || check.value === undefined
          ? null
          : h(
              'span',
              {class: 'num'},
              ` ${number(check.value, 3)}`,
              check.threshold === null || check.threshold === undefined ? '' : ` / ${number(check.threshold, 3)}`,
            ),
        h('span', {class: 'soft'}, say(check.text)),
        check.gains && proposal(check.gains, take),
        check.source && h('span', {class: 'soft source'}, check.source),
      ),
    ),
  );
}

/**
 * @param {NonNullable<Check['gains']>} gains
 * @param {(gains: NonNullable<Check['gains']>) => void} take
 */
function proposal(gains, take) {
  const values = Object.entries(gains).map(
    ([name, list]) => `${name} = ${list.map((one) => number(one, 5)).join(', ')}`,
  );
  return h(
    'button',
    {type: 'button', class: 'press quiet-press control-only', onclick: () => take(gains)},
    t('page.observers.take-gains', {gains: values.join('; ')}),
  );
}

/**
 * Put a list that opens over the page below its button, as wide as the card and within the window.
 * @param {HTMLElement} button
 * @param {HTMLElement} list
 * @param {HTMLElement} card
 */
export function beside(button, list, card) {
  const {left, width} = card.getBoundingClientRect();
  const {top, bottom} = button.getBoundingClientRect();
  const below = innerHeight - bottom - 16;
  Object.assign(list.style, {
    left: `${left}px`,
    width: `${width}px`,
    ...(below > 0.4 * innerHeight
      ? {top: `${bottom + 4}px`, bottom: 'auto', maxHeight: `${below}px`}
      : {top: 'auto', bottom: `${innerHeight - top + 4}px`, maxHeight: `${top - 16}px`}),
  });
}
