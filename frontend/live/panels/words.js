// Events of the session as sentences, in the language of the page.

import {number} from '../../dom.js';
import {amount} from './sizes.js';
import {called, plain} from './symbols.js';

/**
 * Lines for the log, newest first; a gain or noise that was dragged is one line.
 * @returns {{event: object, t: number, words: string, alarm: boolean, own: boolean}[]}
 */
export function lines(log, text, plant, most = 200) {
  const made = [];
  for (let k = log.length - 1; k >= 0 && made.length < most; k -= 1) {
    const event = log[k];
    const newer = log[k + 1];
    const dragged = (event.kind === 'gain' || event.kind === 'noise') && newer?.kind === event.kind && newer.subject === event.subject && newer.value?.gain === event.value?.gain && newer.t - event.t < 5;
    if (event.kind === 'substeps' || dragged) continue;
    made.push({event, t: event.t, words: words(event, text, plant), alarm: event.kind === 'alarm' || event.kind === 'diverged', own: OWN.has(event.kind)});
  }
  return made;
}

const OWN = new Set(['inject', 'clear', 'gain', 'signal', 'noise', 'observer-added', 'observer-removed', 'rewound', 'reset']);

function words(event, text, plant) {
  const say = text.events[event.kind];
  if (!say) return event.text;
  if (event.kind === 'alarm' || event.kind === 'alarm-over') return say(alarmed(event, plant, text));
  return say({name: called(event.subject, plant, text), subject: event.subject, observer: event.observer, ...numbers(event, text), planned: event.value?.planned, t: number(event.t, 4)});
}

/** What an alarm names: the channel and those that explain the data as well, or an output that nothing explains. */
function alarmed({subject, value}, plant, text) {
  const channel = plant.channels.find((one) => one.name === value.channel);
  const names = value.kind === 'fault' ? [value.channel, ...value.alternatives] : [subject];
  const size = value.size === null ? '' : amount({size: value.size, half: (value.size_to - value.size_from) / 2}, channel);
  return {names: names.map((name) => called(name, plant, text)), explained: value.kind === 'fault', size, onset: number(value.onset, 4)};
}

const MAIN = ['size', 'rate', 'intensity', 'value', 'std', 'probability', 'resolution', 'delay']; // what a fault's shape is told by

/** What an event's value says: a number, a gain, or a fault. */
function numbers({value}, text) {
  if (value === null || typeof value !== 'object') return {size: spelt(value)};
  if ('gain' in value) return {gain: plain(value.gain), size: spelt(value.value)};
  const name = MAIN.find((one) => one in value);
  return {size: name ? spelt(value[name]) : '', shape: value.shape && (text.shapes[value.shape] ?? value.shape)};
}

function spelt(value) {
  if (Array.isArray(value)) return `(${value.map(spelt).join(', ')})`;
  return typeof value === 'number' ? number(value, 3) : value ?? '';
}
