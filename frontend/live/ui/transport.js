// Play, pause, step, back to the start, fork, a note, speed, and the clock.

import {fill, h} from '../../common/dom.js';
import {seconds, SPEEDS, times} from '../../widgets/number-format.js';
import {t} from '../../i18n/words.js';

/** @import {App} from '../types.js' */

const ICONS = {
  start: ['M3.5 3v10M12.5 3.5v9L6 8z'],
  step: ['M3.5 3.5v9L10 8zM12.5 3v10'],
  fork: ['M8 13.5V9M8 9C8 6 4 7 4 3.5M8 9c0-3 4-2 4-5.5'],
  note: ['M4 14V2.500h8L10 5.500l2 3H4'],
  play: ['M5 3l8 5-8 5z', true],
  pause: ['M5.500 3.500v9M10.500 3.500v9'],
};

/** @param {keyof typeof ICONS} name @param {number} [size] */
const icon = (name, size = 14) => {
  const [d, filled] = ICONS[name];
  return h(
    'svg',
    {
      viewBox: '0 0 16 16',
      width: size,
      height: size,
      fill: filled ? 'currentColor' : 'none',
      stroke: 'currentColor',
      'stroke-width': name === 'pause' ? 2.4 : 1.6,
      'stroke-linecap': 'round',
      'stroke-linejoin': 'round',
      'aria-hidden': 'true',
    },
    h('path', {d}),
  );
};

/** @param {HTMLElement} root @param {App} app */
export function mountTransport(root, app) {
  /** @param {keyof typeof ICONS} name @param {() => void} act */
  const button = (name, act) => h('button', {type: 'button', class: 'tb', 'data-act': name, onclick: act}, icon(name));
  const start = button('start', () => app.act.reset());
  const step = button('step', () => app.act.step(1));
  const fork = button('fork', () => app.act.fork());
  const note = button('note', () => app.act.notes.begin());
  const play = h('button', {type: 'button', class: 'play', 'data-act': 'play', onclick: () => app.act.toggle()});
  /** @type {HTMLSelectElement} */
  const speed = h('select', {
    class: 'speed',
    onchange: () => app.act.speed(speed.value === 'max' ? null : Number(speed.value)),
  });
  const figures = h('span', {class: 'digits'});
  const clock = h('div', {class: 'clock', role: 'timer'}, figures, h('small', {}, 's'));
  fill(root, start, step, play, fork, note, speed, clock);

  app.subscribe(
    (state) => [state.language, state.role, state.session, state.connection, state.ended, state.playing, state.speed],
    () => {
      const {state} = app;
      const touch = state.role === 'control' && state.connection === 'live';
      name(start, t('page.transport.start'));
      name(step, t('page.transport.step'));
      name(fork, t('page.transport.fork'));
      name(note, t('page.transport.note'));
      name(speed, t('page.transport.speed'));
      clock.title = t('page.transport.clock');
      name(play, state.playing ? t('page.transport.pause') : t('page.transport.play'));
      fill(play, icon(state.playing ? 'pause' : 'play', 16));
      for (const element of [start, note, speed]) element.disabled = !touch;
      for (const element of [step, play]) element.disabled = !touch || state.ended;
      fork.disabled = state.connection !== 'live';
      showSpeeds(speed, state.speed);
    },
  );
  app.onTick(() => {
    // the present, also while looking back: the scope shows that time at its line
    const text = seconds(app.samples.now, app.state.record >= 1 ? 1 : 0.1);
    if (figures.textContent !== text) figures.textContent = text;
  });
}

/** @param {HTMLElement} element @param {string} text */
function name(element, text) {
  element.title = text;
  element.setAttribute('aria-label', text);
}

/** @param {HTMLSelectElement} select @param {number | null} speed */
function showSpeeds(select, speed) {
  const all = SPEEDS.includes(speed)
    ? SPEEDS
    : [...SPEEDS.slice(0, -1), speed].sort((a, b) => Number(a) - Number(b)).concat(null);
  fill(
    select,
    all.map((value) =>
      h(
        'option',
        {value: value ?? 'max', selected: value === speed, title: value === null ? t('page.transport.fastest') : null},
        times(value),
      ),
    ),
  );
}
