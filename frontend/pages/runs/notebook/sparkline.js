// The first fault of a run and its estimate, as a small picture.

import {h} from '../../../common/dom.js';
import {plain} from '../../../common/names.js';
import {t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */

const WIDTH = 92;
const HEIGHT = 22;
const PAD = 2;

/** @param {service.RunCurve | null} curve */
export function sparkline(curve) {
  if (!curve) return null;
  const {truth, estimate} = curve;
  // the estimate converges at the start: the true values and the later estimates set the range
  const late = estimate.slice(Math.floor(estimate.length / 5));
  const values = [...(truth ?? []), ...late].filter((value) => value !== null);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const span = high - low || 1;
  /** @param {readonly (number | null)[]} points */
  const path = (points) => {
    let pen = 'M';
    return points
      .map((value, place) => {
        if (value === null) {
          pen = 'M';
          return '';
        }
        const share = Math.min(Math.max((value - low) / span, 0), 1);
        const x = PAD + ((WIDTH - 2 * PAD) * place) / Math.max(points.length - 1, 1);
        const point = `${pen}${x.toFixed(1)} ${(HEIGHT - PAD - (HEIGHT - 2 * PAD) * share).toFixed(1)}`;
        pen = 'L';
        return point;
      })
      .join('');
  };
  return h(
    'svg',
    {
      class: 'spark',
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      role: 'img',
      'aria-label': t('page.notebook.curve', {name: plain(curve.channel)}),
    },
    h('title', {}, t('page.notebook.curve', {name: plain(curve.channel)})),
    truth && h('path', {d: path(truth), class: 'truth'}),
    h('path', {d: path(estimate), class: 'estimate'}),
  );
}
