// The healthy stretch in the picture: two handles that are dragged or moved by keys, and the veil over the rest.

import {h} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {span} from '../numbers.js';

const MINUTE = 60;

/** @typedef {{begin: number, end: number}} Stretch */
/** @typedef {'begin' | 'end'} End */

/**
 * The stretch with one end moved; it keeps a length of one row, and stays within the record.
 * @param {Stretch} stretch
 * @param {End} which
 * @param {number} to   s
 * @param {{duration: number, period: number}} record
 * @returns {Stretch}
 */
export function moved({begin, end}, which, to, {duration, period}) {
  const steps = Math.round(to / period);
  const at = Number((steps * period).toPrecision(12));
  return which === 'begin'
    ? {begin: Math.min(Math.max(0, at), Math.max(0, end - period)), end}
    : {begin, end: Math.max(Math.min(duration, at), Math.min(duration, begin + period))};
}

/**
 * Where a key moves an end to, or null: a row with the arrows, a minute with shift, Home and End to the record's ends.
 * @param {{key: string, shiftKey: boolean}} event
 * @param {number} at
 * @param {{duration: number, period: number}} record
 */
export function destination({key, shiftKey}, at, {duration, period}) {
  const step = shiftKey ? Math.max(MINUTE, period) : period;
  if (key === 'ArrowLeft' || key === 'ArrowDown') return at - step;
  if (key === 'ArrowRight' || key === 'ArrowUp') return at + step;
  return key === 'Home' ? 0 : key === 'End' ? duration : null;
}

/**
 * The stretch as it lies over a picture.
 * @param {object} options
 * @param {Stretch} options.stretch
 * @param {{duration: number, period: number}} options.record
 * @param {(stretch: Stretch) => void} options.change   when it was moved
 */
export function stretchOver({stretch, record, change}) {
  let present = stretch;
  const veils = [h('div', {class: 'band veil'}), h('div', {class: 'band veil'})];
  const healthy = h('div', {class: 'band healthy'});
  const handles = {begin: handle('begin'), end: handle('end')};
  const whole = h('div', {class: 'stretch'}, veils, healthy, handles.begin, handles.end);
  /** @param {number} at */
  const percent = (at) => `${(100 * at) / (record.duration || 1)}%`;
  const show = () => {
    healthy.style.left = percent(present.begin);
    healthy.style.width = percent(present.end - present.begin);
    veils[0].style.left = '0';
    veils[0].style.width = percent(present.begin);
    veils[1].style.left = percent(present.end);
    veils[1].style.width = percent(record.duration - present.end);
    for (const which of /** @type {const} */ (['begin', 'end'])) {
      handles[which].style.left = percent(present[which]);
      handles[which].setAttribute('aria-valuenow', String(Math.round(present[which])));
      handles[which].setAttribute('aria-valuetext', `${Number(present[which].toPrecision(6))} s`);
    }
  };
  /** @param {End} which */
  function handle(which) {
    return h('div', {
      class: `handle ${which}`,
      id: `stretch-${which}`,
      role: 'slider',
      tabindex: 0,
      'aria-label': which === 'begin' ? t('page.records.healthy.begin') : t('page.records.healthy.end'),
      'aria-valuemin': 0,
      'aria-valuemax': Math.round(record.duration),
      title: t('page.records.healthy.keys', {row: span(record.period)}),
      onpointerdown: (/** @type {PointerEvent} */ event) => drag(event, which),
      onkeydown: (/** @type {KeyboardEvent} */ event) => {
        const to = destination(event, present[which], record);
        if (to === null) return;
        event.preventDefault();
        present = moved(present, which, to, record);
        show();
        change(present);
      },
    });
  }
  /** @param {PointerEvent} event @param {End} which */
  function drag(event, which) {
    const target = /** @type {HTMLElement} */ (event.currentTarget);
    const box = whole.getBoundingClientRect();
    event.preventDefault();
    target.focus();
    target.setPointerCapture(event.pointerId);
    target.onpointermove = ({clientX}) => {
      present = moved(present, which, ((clientX - box.left) / box.width) * record.duration, record);
      show();
    };
    target.onpointerup = () => {
      target.onpointermove = target.onpointerup = null;
      change(present);
    };
  }
  show();
  return whole;
}
