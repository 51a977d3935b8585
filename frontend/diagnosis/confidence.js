// How sure? Where the thresholds come from, what ± means, and the noise as declared and as it is.

import {fill, h, number} from '../common/dom.js';
import {called, spoken} from '../common/names.js';

/** @returns {{element: HTMLElement, show: () => void}} */
export function createSure(app) {
  const element = h('div', {class: 'fold-out scroll small', hidden: true, tabindex: 0, role: 'region'});
  const show = () => {
    const {state, text} = app;
    element.setAttribute('aria-label', text.howSure);
    fill(
      element,
      certainty(state, text).map((words) => h('p', {}, words)),
    );
  };
  return {element, show};
}

/** One paragraph each. */
export function certainty({diagnosis, spec, plant}, text) {
  const {calibration: cal, noise = [], note} = diagnosis ?? {};
  if (!cal) return [note ? spoken(text.said(note), plant, text) : text.wait];
  const asked =
    cal.false_alarms < 1 ? text.oneIn(number(1 / cal.false_alarms, 3)) : text.perHour(number(cal.false_alarms, 3));
  const said = [
    text.calibrated(asked, number(cal.thresholds.glr, 3), cal.seeds, number(cal.hours, 2)),
    text.plusMinus(number(100 * spec.diagnosis.confidence, 3)),
    text.judgedFrom(number(cal.from_time, 3)),
  ];
  for (const {output, declared, estimated} of noise) {
    if (estimated !== null)
      said.push(
        text.noiseSeen(
          called(output, plant, text),
          declared === null ? null : number(declared, 3),
          number(estimated, 3),
        ),
      );
  }
  return [...said, text.bandsAre, cal.note && spoken(text.said(cal.note), plant, text)].filter(Boolean);
}
