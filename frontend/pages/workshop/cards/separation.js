// The matrix of faults: seconds until each is found, and until it is distinguished from each other one.

import {h, number} from '../../../common/dom.js';
import {badges} from '../../../common/names.js';
import {badge} from '../../../widgets/controls.js';
import {named, t} from '../../../i18n/words.js';

/** @import {ShopState} from '../types.js' */

const SLOW = 0.02; // of the experiment: what takes longer is amber
const MOST = 8;

/** @param {ShopState} state */
export function separation(state) {
  const plant = state.good?.plant;
  if (!plant || !state.trial)
    return state.trialProblem ? '' : h('p', {class: 'soft busy'}, t('page.workshop.simulating'));
  const {seconds, t: times} = state.trial.preview;
  const channels = plant.channels.slice(0, Math.min(MOST, seconds.length));
  if (channels.length === 0) return h('p', {class: 'soft'}, t('page.workshop.apart.none'));
  const signs = badges(plant.channels);
  const slow = SLOW * (times.at(-1) ?? 1);
  /** @param {number | null} value @param {boolean} self */
  const cell = (value, self) => {
    if (value === null) return h('td', {class: 'never'}, t('page.workshop.apart.no'));
    return h('td', {class: self ? 'self' : value > slow ? 'slow' : ''}, number(value, 2));
  };
  const table = h(
    'table',
    {class: 'matrix'},
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('td', {}),
        channels.map((one) =>
          h('th', {scope: 'col', title: named(one.title) || one.name}, badge(signs.get(one.name) ?? [one.name, ''])),
        ),
      ),
    ),
    h(
      'tbody',
      {},
      channels.map((one, row) =>
        h(
          'tr',
          {},
          h('th', {scope: 'row', class: 'rowname', title: named(one.title)}, one.name),
          channels.map((_, column) => cell(seconds[row][column], row === column)),
        ),
      ),
    ),
  );
  const pairs = channels.flatMap((one, row) =>
    channels
      .slice(row + 1)
      .flatMap((other, offset) => (seconds[row][row + 1 + offset] === null ? [[one.name, other.name]] : [])),
  );
  return [
    h('div', {class: 'matrix-box', tabindex: 0, role: 'group', 'aria-label': t('page.workshop.apart')}, table),
    h(
      'p',
      {class: 'soft'},
      pairs.length
        ? t('page.workshop.apart.pairs', {
            pairs: pairs.slice(0, 3).map(([a, b]) => t('page.workshop.apart.pair', {a, b})),
          })
        : t('page.workshop.apart.about'),
    ),
    plant.channels.length > channels.length &&
      h('p', {class: 'soft'}, t('page.workshop.apart.more', {n: plant.channels.length - channels.length})),
    h(
      'details',
      {},
      h('summary', {}, t('page.workshop.apart.how')),
      h('p', {class: 'soft'}, t('page.workshop.apart.how.text')),
    ),
  ];
}
