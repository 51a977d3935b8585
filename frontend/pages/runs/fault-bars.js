// When each fault acts, as bars over the horizon.

import {fill, h, number, symbol} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';

/** @import {Experiment, Plant} from '../types.js' */

/**
 * The timeline of an experiment, with what its plant says of the channels.
 * @param {Experiment} spec
 * @param {Plant | null} plant
 */
export function timeline(spec, plant) {
  if (!spec.faults.length) return h('p', {class: 'soft'}, t('page.runs.no-faults'));
  const rows = spec.faults.map((fault) => {
    const name = 'channel' in fault ? fault.channel : fault.output;
    const channel = plant?.channels.find((one) => one.name === name);
    /** @param {number} time */
    const share = (time) => `${Math.min(100, (100 * time) / spec.horizon)}%`;
    const from = fault.onset;
    const to = fault.end ?? spec.horizon;
    const title = named(channel?.title);
    const shape = t(`page.fault.shape.${fault.shape}`);
    return h(
      'li',
      {
        title:
          typeof fault.end === 'number'
            ? t('page.runs.fault', {name: title || name, shape, onset: number(from, 6), end: number(fault.end, 6)})
            : t('page.runs.fault-open', {name: title || name, shape, onset: number(from, 6)}),
      },
      h('span', {class: 'name'}, symbol(name), h('small', {}, [title, shape].filter(Boolean).join(', '))),
      h(
        'span',
        {class: 'track'},
        h(
          'span',
          {class: 'bar', style: `left:${share(from)};right:calc(100% - ${share(to)})`},
          h('small', {}, `${number(from, 6)} s`),
        ),
      ),
    );
  });
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((share) =>
    h('span', {}, String(Number((share * spec.horizon).toFixed(spec.horizon >= 20 ? 1 : 3)))),
  );
  return fill(
    h('div', {class: 'timeline'}),
    h('ul', {'aria-label': t('page.runs.timeline')}, rows),
    h('div', {class: 'ticks', 'aria-hidden': 'true'}, ticks),
  );
}
