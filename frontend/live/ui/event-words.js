// Events of the session as sentences, in the language of the page.

import {number} from '../../common/dom.js';
import {called, plain} from '../../common/names.js';
import {amount} from '../../diagnosis/fault-size.js';

const DRAGGED = 5; // s between two values of one slider that are told as one

/**
 * Lines for the log, newest first: by the time of what they tell, as an alarm, say, is told later than it was raised. A gain or noise that was dragged
 * is one line. `signs`: what the observers' gains are called.
 * @returns {{event: object, t: number, words: string, alarm: boolean, own: boolean}[]}
 */
export function lines(log, text, plant, signs = {}, most = 200) {
  const told = log
    .filter(({kind}) => kind !== 'substeps')
    .map((event, place) => ({event, place}))
    .sort((a, b) => b.event.t - a.event.t || b.place - a.place);
  const made = [];
  for (const [place, {event}] of told.entries()) {
    if (made.length >= most) break;
    const next = told[place - 1]?.event;
    if (dragged(event, next) || restarted(event, next)) continue;
    const said = restarted(told[place + 1]?.event, event)
      ? text.events.restarted(event)
      : words(event, text, plant, signs);
    made.push({
      event,
      t: event.t,
      words: said,
      alarm: event.kind === 'alarm' || event.kind === 'diverged',
      own: OWN.has(event.kind),
    });
  }
  return made;
}

/** Whether a slider went on from a gain or a noise to the next. */
const dragged = (event, next) =>
  (event.kind === 'gain' || event.kind === 'noise') &&
  next?.kind === event.kind &&
  next.subject === event.subject &&
  next.value?.gain === event.value?.gain &&
  next.t - event.t < DRAGGED;

/** Whether an observer was taken away and put back in one row: it was started again. */
const restarted = (removed, added) =>
  removed?.kind === 'observer-removed' &&
  added?.kind === 'observer-added' &&
  removed.subject === added.subject &&
  removed.row === added.row;

const OWN = new Set([
  'inject',
  'clear',
  'gain',
  'signal',
  'noise',
  'observer-added',
  'observer-removed',
  'rewound',
  'reset',
]);

function words(event, text, plant, signs) {
  const say = text.events[event.kind];
  if (!say) return event.text;
  if (event.kind === 'alarm' || event.kind === 'alarm-over') return text.tight(say(alarmed(event, plant, text)));
  return text.tight(
    say({
      name: event.subject && called(event.subject, plant, text),
      subject: event.subject,
      observer: event.observer,
      ...numbers(event, text, signs),
      planned: event.value?.planned,
      t: number(event.t, 4),
    }),
  );
}

/** What an alarm names: the channel and those that explain the data as well, or an output that nothing explains. */
function alarmed({subject, value}, plant, text) {
  const channel = plant.channels.find((one) => one.name === value.channel);
  const names = value.kind === 'fault' ? [value.channel, ...value.alternatives] : [subject];
  const size =
    value.size === null ? '' : amount({size: value.size, half: (value.size_to - value.size_from) / 2}, channel);
  return {
    names: names.map((name) => called(name, plant, text)),
    explained: value.kind === 'fault',
    size,
    onset: number(value.onset, 4),
  };
}

/** What a fault's shape is told by; anything but a size is told with its name. */
const MAIN = ['size', 'rate', 'intensity', 'value', 'std', 'probability', 'resolution', 'delay', 'values'];

/** What an event's value says: a number, a gain, or a fault. */
function numbers({value, t}, text, signs) {
  if (value === null || typeof value !== 'object') return {size: spelt(value)};
  if ('gain' in value) return {gain: signs[value.gain] ?? plain(value.gain), size: spelt(value.value)};
  const name = MAIN.find((one) => one in value);
  return {
    size: name ? spelt(value[name]) : '',
    quantity: name && name !== 'size' ? text.fields[name] : '',
    shape: value.shape && (text.shapes[value.shape] ?? value.shape),
    later: value.onset > 0 ? (t + value.onset).toFixed(1) : '',
  };
}

function spelt(value) {
  if (Array.isArray(value)) return `(${value.map(spelt).join(', ')})`;
  return typeof value === 'number' ? number(value, 3) : (value ?? '');
}
