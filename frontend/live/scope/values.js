// The numbers beside the strips: at the pointer, else at the time that is looked back to, else at the right edge of
// the curves.

import {power} from '../../widgets/number-format.js';
import {written} from './axis-view.js';
import {t} from '../../i18n/words.js';

/** @import {App, Row, State, Strip} from '../types.js' */

/**
 * The time whose values are shown.
 * @param {Pick<State, 'cursor' | 'looking' | 'selection'>} state
 * @param {number} now
 */
export const moment = ({cursor, looking, selection}, now) => Math.min(now, cursor ?? looking ?? selection?.[1] ?? now);

/**
 * Fill the cells beside every row of the scope.
 * @param {Iterable<Row>} rows
 * @param {App} app
 */
export function showValues(rows, app) {
  const {state, samples} = app;
  const row = Math.min(samples.rows - 1, Math.round(moment(state, samples.now) / samples.record));
  for (const {strip, values, range, canvas} of rows) {
    const format = strip.log
      ? excitation
      : written(range.target ? {low: range.target[0], high: range.target[1]} : range);
    const shown = [
      ...(strip.truth ? [{column: strip.truth, label: truthOf(strip), fallen: null}] : []),
      ...(strip.reading ? [{...strip.reading, fallen: null}] : []),
      ...strip.traces,
    ];
    const words = shown.map(({column, fallen, label}, i) => {
      const value = samples.value(column, row);
      const text = fallen !== null && value !== value ? t('page.scope.diverged') : format(value);
      const cell = values.children[i];
      put(cell, text);
      if (strip.log) cell?.classList.toggle('warning', text === t('page.scope.diverged'));
      return `${label} ${text}`;
    });
    if (strip.log && shown.length === 1)
      words.push(judge(values.children[1], samples.value(shown[0].column, row), strip));
    if (!state.playing)
      canvas.setAttribute('aria-label', t('page.text.values', {title: canvas.dataset.name, values: words.join(', ')}));
  }
}

/** The name of a strip's dashed curve. @param {Strip} strip */
export const truthOf = ({kind, name}) =>
  kind !== 'loop'
    ? t('page.scope.truth')
    : t(name.startsWith('r.') ? 'page.plant.set-point-short' : 'page.scope.applied');

/** @param {Element | undefined} cell @param {string} words */
const put = (cell, words) => {
  if (cell && cell.textContent !== words) cell.textContent = words;
};

/** @param {number} value */
const excitation = (value) => (value === value ? power(10 ** value) : '–');

/**
 * Whether the one observer's excitation suffices.
 * @param {Element | undefined} cell
 * @param {number} value
 * @param {Strip} strip
 */
function judge(cell, value, {threshold}) {
  const words =
    value !== value || threshold === null
      ? ''
      : value >= threshold
        ? t('page.scope.excited')
        : t('page.scope.not-excited');
  put(cell, words);
  cell?.classList.toggle('warning', words === t('page.scope.not-excited'));
  return words;
}
