// How sure? Where the thresholds come from, what ± means, and the noise as declared and as it is.

import {fill, h, number} from '../common/dom.js';
import {called, spoken} from '../common/names.js';
import {t} from '../i18n/words.js';

/** @import {App, DiagnosisState} from '../live/types.js' */

/**
 * @param {App} app
 * @returns {{element: HTMLElement, show: () => void}}
 */
export function createSure(app) {
  const element = h('div', {class: 'fold-out scroll small', hidden: true, tabindex: 0, role: 'region'});
  const show = () => {
    const {state} = app;
    element.setAttribute('aria-label', t('page.diagnosis.certainty'));
    fill(
      element,
      certainty(state).map((words) => h('p', {}, words)),
    );
  };
  return {element, show};
}

/**
 * Where the thresholds come from and what the intervals mean, one paragraph each.
 * @param {DiagnosisState} state
 * @returns {string[]}
 */
export function certainty({diagnosis, spec, plant}) {
  const {calibration: cal, noise = [], note} = diagnosis ?? {};
  if (!cal) return [note ? spoken(note, plant) : t('page.text.loading')];
  const rate =
    cal.false_alarms < 1
      ? t('page.certainty.one-in', {hours: number(1 / cal.false_alarms, 3)})
      : t('page.certainty.per-hour', {n: number(cal.false_alarms, 3)});
  const paragraphs = [
    t('page.certainty.calibrated', {
      rate,
      threshold: number(cal.thresholds.glr, 3),
      runs: cal.seeds,
      hours: number(cal.hours, 2),
    }),
    t('page.certainty.interval', {percent: number(100 * (spec?.diagnosis.confidence ?? NaN), 3)}),
    t('page.certainty.judged-from', {s: number(cal.from_time, 3)}),
  ];
  for (const {output, declared, estimated} of noise) {
    if (estimated !== null)
      paragraphs.push(
        declared === null
          ? t('page.certainty.noise-undeclared', {output: called(output, plant), estimated: number(estimated, 3)})
          : t('page.certainty.noise', {
              output: called(output, plant),
              declared: number(declared, 3),
              estimated: number(estimated, 3),
            }),
      );
  }
  return [...paragraphs, t('page.certainty.bands'), ...(cal.note ? [spoken(cal.note, plant)] : [])];
}
