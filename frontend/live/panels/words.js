// Events of the session as sentences, in the language of the page.

import {number} from '../../dom.js';
import {plain} from './symbols.js';

/**
 * Lines for the log, newest first; a gain or noise that was dragged is one line.
 * @returns {{t: number, words: string, alarm: boolean, own: boolean}[]}
 */
export function lines(log, text, most = 200) {
  const made = [];
  for (let k = log.length - 1; k >= 0 && made.length < most; k -= 1) {
    const event = log[k];
    const newer = log[k + 1];
    const dragged = (event.kind === 'gain' || event.kind === 'noise') && newer?.kind === event.kind && newer.subject === event.subject && newer.t - event.t < 5;
    if (event.kind === 'substeps' || dragged) continue;
    made.push({t: event.t, words: words(event, text), alarm: event.kind === 'alarm' || event.kind === 'diverged', own: OWN.has(event.kind)});
  }
  return made;
}

const OWN = new Set(['inject', 'clear', 'gain', 'signal', 'noise', 'observer-added', 'observer-removed', 'rewound', 'reset']);

function words(event, text) {
  const say = text.events[event.kind];
  if (!say) return event.text;
  return say({name: plain(event.subject), subject: event.subject, observer: event.observer, ...numbers(event), t: number(event.t, 4)});
}

/** Numbers within an event's value, whatever form it has. */
function numbers({value}) {
  if (typeof value === 'number') return {size: number(value, 3)};
  if (value === null || typeof value !== 'object') return {size: value ?? ''};
  if ('estimate' in value) return {size: number(value.estimate, 2)};
  const [name, first] = Object.entries(value)[0] ?? ['', ''];
  const list = Array.isArray(first) ? first.map((one) => number(one, 3)).join(', ') : typeof first === 'number' ? number(first, 3) : first;
  return {size: list, gain: plain(name), shape: value.shape};
}
