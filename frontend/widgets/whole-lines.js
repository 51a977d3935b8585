// Lists that end with a whole line: what does not fit is scrolled to, and the rim of the card says how many lines
// follow. All lists are fitted together, since the cards of a column share its height.

import {h} from '../common/dom.js';
import {t} from '../i18n/words.js';

/** @import {App} from '../live/types.js' */

const LOST = 80; // px of room that may stay empty below the last whole line; a taller one is cut after all

/**
 * A list that is kept whole.
 * @typedef {{list: HTMLElement, more: HTMLElement, lines: () => HTMLElement[]}} Kept
 */

/** @type {Set<Kept>} */
const kept = new Set();
let pending = 0;
let wanted = true; // whatever the lists hold
let fitted = ''; // the shape that the lists were fitted in
/** @param {boolean} [whatever]   also if the lists keep their shape */
const soon = (whatever = true) => {
  wanted ||= whatever;
  pending ||= requestAnimationFrame(() => {
    pending = 0;
    if (wanted || shape() !== fitted) fitAll();
  });
};
const resized = new ResizeObserver(() => soon());
addEventListener('resize', () => soon());

/** The heights of all lists, and the ends of their lines. */
const shape = () =>
  [...kept]
    .map(({list, lines}) => [
      list.clientHeight,
      list.scrollHeight,
      list.scrollTop,
      ...lines().map((line) => bottom(line, list)),
    ])
    .join('|');

/**
 * End a scrolling list with a whole line. `lines()` returns its lines from the top. Returns a button for the card that
 * says how many lines follow.
 * @param {HTMLElement} list
 * @param {() => HTMLElement[]} lines
 * @param {App} app
 * @returns {HTMLButtonElement}
 */
export function wholeLines(list, lines, app) {
  const more = h('button', {
    type: 'button',
    class: 'more-lines',
    hidden: true,
    onclick: () => list.scrollBy({top: list.clientHeight - 8, behavior: 'smooth'}),
  });
  const one = {list, more, lines: () => lines().filter((line) => line.offsetHeight > 0)};
  kept.add(one);
  list.addEventListener('scroll', () => show(one, below(one)), {passive: true});
  new MutationObserver((changes) => {
    if (changes.some(matters)) soon(false);
  }).observe(list, {childList: true, subtree: true, attributeFilter: ['hidden', 'open']});
  app.subscribe(
    (state) => [state.language, state.presentation],
    () => soon(),
  );
  return more;
}

/**
 * Numbers that change within a line change no line.
 * @param {MutationRecord} change
 */
const matters = ({type, addedNodes, removedNodes}) =>
  type === 'attributes' || [...addedNodes, ...removedNodes].some((node) => node.nodeType === Node.ELEMENT_NODE);

/**
 * The lower end of a line, from the top of the visible part.
 * @param {Element} line
 * @param {HTMLElement} list
 */
const bottom = (line, list) => line.getBoundingClientRect().bottom - list.getBoundingClientRect().top;

function fitAll() {
  wanted = false;
  for (const {list} of kept)
    // a capped list does not grow with its card
    for (const one of [list, list.closest('.card')]) if (one?.isConnected) resized.observe(one);
  const before = [...kept].map((one) => ({one, top: one.list.scrollTop, line: inUse(one)}));
  // a projector's card has one size, whatever is in it
  const free = [...kept].filter(({list}) => !list.closest('.desk'));
  for (const {list} of kept) cap(list, null);
  const whole = new Map(free.map((one) => [one, lastWhole(one)]));
  for (const [{list}, end] of whole) if (end) cap(list, end);
  for (const [one, end] of whole) if (end && grows(one.list)) refit(one); // they get the room that the others left
  // a list that was higher for a moment may have scrolled less
  for (const {one, top} of before) if (top > 0 && one.list.scrollTop !== top) one.list.scrollTop = top;
  for (const {one, line} of before) {
    const out = line ? bottom(line, one.list) - one.list.clientHeight : 0;
    if (out > 0) one.list.scrollTop += out; // a line that is in use stays whole
  }
  // all are counted before the first number is written: a layout each would take longer than everything else
  const counts = before.map(({one}) => /** @type {const} */ ([one, below(one)]));
  fitted = shape();
  for (const [one, lines] of counts) show(one, lines);
}

/**
 * The line with the focus, if it is seen whole.
 * @param {Kept} kept
 */
function inUse({list, lines}) {
  const line = list.contains(document.activeElement)
    ? lines().find((each) => each.contains(document.activeElement))
    : null;
  return line && bottom(line, list) <= list.clientHeight + 1 ? line : null;
}

/** @param {HTMLElement} list */
const grows = (list) => getComputedStyle(list.closest('.card') ?? list).flexGrow !== '0';

/** @param {Kept} one */
function refit(one) {
  cap(one.list, null);
  const end = lastWhole(one);
  if (end) cap(one.list, end);
}

/**
 * How high the lines are that fit whole; null where all fit, or where too much would stay empty.
 * @param {Kept} kept
 */
function lastWhole({list, lines}) {
  const room = list.clientHeight;
  if (list.scrollHeight <= room + 1) return null;
  const end = Math.max(
    0,
    ...lines()
      .map((line) => bottom(line, list) + list.scrollTop)
      .filter((one) => one <= room + 0.5),
  );
  return end > 0 && room - end < LOST ? Math.ceil(end) : null;
}

/**
 * A list that has given way already gives way no further.
 * @param {HTMLElement} list
 * @param {number | null} height
 */
function cap(list, height) {
  list.style.maxHeight = height === null ? '' : `${height}px`;
  const card = list.closest('.card');
  if (card instanceof HTMLElement && !card.matches('.desk .card')) card.style.flexShrink = height === null ? '' : '0';
}

/**
 * How many lines follow below the visible part.
 * @param {Kept} kept
 */
const below = ({list, lines}) => lines().filter((line) => bottom(line, list) > list.clientHeight + 2).length;

/** @param {Kept} kept @param {number} count */
function show({more}, count) {
  more.hidden = count === 0;
  const words = count ? t('page.text.more-lines', {n: count}) : '';
  if (more.textContent !== words) more.textContent = words;
}
