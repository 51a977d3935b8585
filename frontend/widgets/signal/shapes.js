// The shapes of an input: which one begins now, its sliders, and how it goes on without a jump when one of them moves.

import {linear, logarithmic, nice} from '../slider-scale.js';

/** @import {Scale} from '../slider-scale.js' */
/** @import * as service from '../../types/service.js' */

/** @typedef {service.SetSignal['signal']} Signal */
/** @typedef {{[field: string]: number}} Numbers   the numbers among the fields of a signal */

/**
 * The values and times that an input may have.
 * @typedef {object} Room
 * @property {number} low      least value that a slider offers
 * @property {number} high
 * @property {number} level    the present value
 * @property {number} step     step of the integration in s
 * @property {number} horizon  in s
 */

/**
 * A slider of a signal. `change` returns the signal with another value, which acts from the time `now` on.
 * @typedef {object} Slider
 * @property {string} name     around, size, period …
 * @property {'own' | 's' | 'Hz' | 'own/s' | ''} unit
 * @property {number} value
 * @property {Scale} scale
 * @property {boolean} positive
 * @property {boolean} whole   whether only integers are accepted
 * @property {(value: number, now: number) => Signal} change
 */

/** All shapes, in the order of the menu; `drawn` is a table that is drawn by hand. */
export const SHAPES = [
  'constant',
  'square',
  'pulse',
  'sine',
  'chirp',
  'prbs',
  'steps',
  'table',
  'noise',
  'drawn',
  'ramp',
  'expression',
];

const MOST_STEPS = 200;

/** @param {Signal} signal */
const numbersOf = (signal) => /** @type {Numbers} */ (/** @type {unknown} */ (signal));

/**
 * Mean, half height and period of a signal, where its shape has them.
 * @param {Signal} signal
 * @returns {{around?: number, size?: number, period?: number}}
 */
export function traits(signal) {
  const s = numbersOf(signal);
  switch (signal.kind) {
    case 'constant':
      return {around: s.value};
    case 'sine':
    case 'square':
      return {
        around: s.offset,
        size: Math.abs(s.amplitude),
        period: s.period ?? (s.frequency > 0 ? 1 / s.frequency : undefined),
      };
    case 'chirp':
      return {around: s.offset, size: Math.abs(s.amplitude), period: s.f0 > 0 ? 1 / s.f0 : undefined};
    case 'pulse':
    case 'prbs':
      return {around: (s.low + s.high) / 2, size: Math.abs(s.high - s.low) / 2, period: s.period ?? 2 * s.hold};
    case 'noise':
      return {around: s.offset, size: s.std, period: 2 * s.hold};
    case 'ramp':
      return {around: s.initial};
    case 'steps':
    case 'table': {
      const [low, high] = extent(signal.values);
      return {around: (low + high) / 2, size: (high - low) / 2};
    }
    default:
      return {};
  }
}

/** @param {number[]} values @returns {[number, number]} */
const extent = (values) => [
  values.reduce((least, value) => Math.min(least, value), Infinity),
  values.reduce((most, value) => Math.max(most, value), -Infinity),
];

/** @param {number} value */
const short = (value) => Number(value.toPrecision(4));

/**
 * A signal of a shape that begins at a time; mean, height and period of the earlier signal are kept where it has them.
 * @param {string} shape
 * @param {Signal} before
 * @param {Room} room
 * @param {number} now   in s
 * @returns {Signal}
 */
export function begun(shape, before, room, now) {
  const known = traits(before);
  const level = before.kind === 'constant' ? before.value : (known.around ?? room.level);
  const around = short(level);
  const free = Math.min(room.high - around, around - room.low);
  const size = known.size || nice((free > 0 ? free : room.high - room.low) / 4) || 1;
  const period = known.period ?? nice(room.horizon / 10);
  const start = short(now);
  /** @type {{[shape: string]: () => Signal}} */
  const made = {
    constant: () => ({kind: 'constant', value: around}),
    square: () => ({kind: 'square', amplitude: size, period, start: now, offset: around}),
    pulse: () => ({kind: 'pulse', low: around, high: short(around + size), period, width: period / 4, start: now}),
    sine: () => ({kind: 'sine', amplitude: size, frequency: 1 / period, phase: turned(-now / period), offset: around}),
    chirp: () => ({
      kind: 'chirp',
      amplitude: size,
      f0: short(1 / period),
      f1: short(5 / period),
      duration: short(Math.min(4 * period, room.horizon)),
      offset: around,
      start: now,
    }),
    prbs: () => ({
      kind: 'prbs',
      low: short(around - size),
      high: short(around + size),
      hold: period / 4,
      seed: 0,
      order: null,
    }),
    noise: () => ({kind: 'noise', std: size, hold: period / 8, seed: 0, offset: around}),
    steps: () => staircase({first: around, last: short(around + size), count: 3, each: period / 2}, now),
    ramp: () => ({kind: 'ramp', start: now, slope: nice(size / period), initial: around, end: now + period}),
    table: () => ({
      kind: 'table',
      times: [start, start + period / 2, start + period],
      values: [around, short(around + size), around],
      interpolation: 'linear',
    }),
    expression: () => ({kind: 'expression', text: `${around} + ${size}*sin(${short((2 * Math.PI) / period)}*t)`}),
  };
  return made[shape === 'drawn' ? 'constant' : shape]();
}

/**
 * A phase in rad between −π and π.
 * @param {number} turns
 */
const turned = (turns) => 2 * Math.PI * (turns - Math.round(turns));

/**
 * The share of the present period that has passed.
 * @param {number} now
 * @param {number} start
 * @param {number} period
 */
const passed = (now, start, period) => ((((now - start) / period) % 1) + 1) % 1;

/** @typedef {{first: number, last: number, count: number, each: number}} Stairs */

/**
 * Steps of equal height and length, from a time on.
 * @param {Stairs} stairs
 * @param {number} start
 * @returns {Signal}
 */
export function staircase({first, last, count, each}, start) {
  const whole = Math.min(MOST_STEPS, Math.max(1, Math.round(count)));
  const place = (/** @type {number} */ k) => first + ((last - first) * k) / whole;
  return {
    kind: 'steps',
    times: Array.from({length: whole}, (_, k) => start + k * each),
    values: Array.from({length: whole + 1}, (_, k) => Number(place(k).toPrecision(12))),
  };
}

/**
 * Height, number and length of steps that are all alike; null for others.
 * @param {Signal} signal
 * @returns {Stairs | null}
 */
export function stairsOf(signal) {
  if (signal.kind !== 'steps') return null;
  const {times, values} = signal;
  const count = times.length;
  const each = count > 1 ? times[1] - times[0] : NaN;
  const [first, last] = [values[0], values[count]];
  const near = 1e-6 * (Math.abs(first) + Math.abs(last) + 1e-300);
  const even =
    count <= MOST_STEPS &&
    times.every((time, k) => k === 0 || Math.abs(time - times[0] - k * each) < 1e-6 * each * count) &&
    values.every((value, k) => Math.abs(value - first - ((last - first) * k) / count) <= near);
  return even && count > 1 ? {first, last, count, each} : null;
}

/**
 * The sliders of a signal.
 * @param {Signal} signal
 * @param {Room} room
 * @returns {Slider[]}
 */
export function sliders(signal, room) {
  const s = numbersOf(signal);
  /** @param {object} changes */
  const changed = (changes) => /** @type {Signal} */ ({...signal, ...changes});
  const height = room.high - room.low;
  const level = linear(room.low, room.high);
  const most = Math.max(room.horizon, 20 * room.step);
  const times = logarithmic(Math.max(2 * room.step, most / 2000), most);
  const speeds = logarithmic(1 / most, Math.min(0.2 / room.step, 200 / most));
  /**
   * @param {string} name
   * @param {number} value
   * @param {Slider['change']} change
   * @param {Partial<Slider>} [more]
   * @returns {Slider}
   */
  const one = (name, value, change, more = {}) => ({
    name,
    value,
    change,
    unit: 'own',
    scale: level,
    positive: false,
    whole: false,
    ...more,
  });
  /** @param {string} name @param {number} value @param {Slider['change']} change */
  const time = (name, value, change) => one(name, value, change, {unit: 's', scale: times, positive: true});
  /** @param {string} name @param {number} value @param {Slider['change']} change */
  const size = (name, value, change) => one(name, value, change, {scale: logarithmic(height / 2000, height, true)});
  const offset = () => one('around', s.offset, (value) => changed({offset: value}));
  const amplitude = () => size('size', s.amplitude, (value) => changed({amplitude: value}));
  const between = () => {
    const {around = 0, size: half = 0} = traits(signal);
    return [
      one('around', around, (value) => changed({low: value - half, high: value + half})),
      size('size', half, (value) => changed({low: around - value, high: around + value})),
    ];
  };
  const hold = () => time('hold', s.hold, (value) => changed({hold: value}));
  /** @type {{[kind: string]: () => Slider[]}} */
  const all = {
    constant: () => [one('level', s.value, (value) => changed({value}))],
    sine: () => [
      offset(),
      amplitude(),
      time('period', s.frequency > 0 ? 1 / s.frequency : most, (value, now) => {
        const turns = s.frequency * now + s.phase / (2 * Math.PI) - now / value;
        return changed({frequency: 1 / value, phase: turned(turns)});
      }),
    ],
    square: () => [
      offset(),
      amplitude(),
      time('period', s.period, (value, now) =>
        changed({period: value, start: now - passed(now, s.start, s.period) * value}),
      ),
    ],
    pulse: () => [
      one('low', s.low, (value) => changed({low: value})),
      one('high', s.high, (value) => changed({high: value})),
      time('period', s.period, (value, now) =>
        changed({
          period: value,
          width: Math.min(value, (s.width * value) / s.period),
          start: now < s.start ? s.start : now - passed(now, s.start, s.period) * value,
        }),
      ),
      time('width', s.width, (value) => changed({width: Math.min(value, s.period)})),
    ],
    chirp: () => [
      offset(),
      amplitude(),
      one('f0', s.f0, (value, now) => changed({f0: value, start: now}), {unit: 'Hz', scale: speeds}),
      one('f1', s.f1, (value, now) => changed({f1: value, start: now}), {unit: 'Hz', scale: speeds}),
      time('duration', s.duration, (value, now) => changed({duration: value, start: now})),
    ],
    prbs: () => [...between(), hold()],
    noise: () => [offset(), size('deviation', s.std, (value) => changed({std: Math.abs(value)})), hold()],
    ramp: () => [
      one(
        'slope',
        s.slope,
        (value, now) => changed({slope: value, initial: rampAt(s, now), start: now, end: laterEnd(s, now)}),
        {
          unit: 'own/s',
          scale: linear(-height / (0.1 * most), height / (0.1 * most)),
        },
      ),
      time('duration', s.end === null ? most : s.end - s.start, (value, now) =>
        changed({initial: rampAt(s, now), start: now, end: now + value}),
      ),
    ],
    steps: () => {
      const stairs = stairsOf(signal);
      if (!stairs) return [];
      /** @param {Partial<Stairs>} changes @param {number} [now] */
      const anew = (changes, now = signal.kind === 'steps' ? signal.times[0] : 0) =>
        staircase({...stairs, ...changes}, now);
      return [
        one('first', stairs.first, (value) => anew({first: value})),
        one('last', stairs.last, (value) => anew({last: value})),
        one('count', stairs.count, (value, now) => anew({count: value}, now), {
          unit: '',
          scale: linear(2, 20),
          positive: true,
          whole: true,
        }),
        time('each', stairs.each, (value, now) => anew({each: value}, now)),
      ];
    },
  };
  return all[signal.kind]?.() ?? [];
}

/** @param {Numbers} s @param {number} t */
const rampAt = (s, t) => s.initial + s.slope * Math.max(0, Math.min(t, s.end ?? Infinity) - s.start);

/** @param {Numbers} s @param {number} now */
const laterEnd = (s, now) => (s.end === null ? null : Math.max(s.end, now + (s.end - s.start) / 100));

/**
 * The length of time in s that shows a signal's shape: some periods of it.
 * @param {Signal} signal
 * @param {number} horizon
 */
export function stretch(signal, horizon) {
  const s = numbersOf(signal);
  const {period} = traits(signal);
  const times = 'times' in signal ? signal.times : [0];
  const whole = times[times.length - 1] - times[0];
  const wanted =
    signal.kind === 'chirp'
      ? 1.6 * s.duration
      : signal.kind === 'ramp' && s.end !== null
        ? 2 * (s.end - s.start)
        : whole * 1.6;
  const span = signal.kind === 'prbs' || signal.kind === 'noise' ? 24 * s.hold : wanted || 3.5 * (period ?? 0);
  return Math.min(horizon, span || 0.3 * horizon);
}
