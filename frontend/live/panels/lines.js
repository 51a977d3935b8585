// Lists that end with a whole line: what does not fit is scrolled to, and the rim of the card says how many lines follow. All lists are fitted
// together, since the cards of a column share its height.

import {h} from '../../dom.js';

const LOST = 80; // px of room that may stay empty below the last whole line; a taller one is cut after all

const kept = new Set();
let asked = 0;
const soon = () => { asked ||= requestAnimationFrame(() => { asked = 0; fitAll(); }); };
const resized = new ResizeObserver(soon);
addEventListener('resize', soon);

/**
 * Keep a scrolling list whole. `lines()` are its lines from above; what it returns says how many are out of sight below, and goes into the card.
 * @returns {HTMLButtonElement}
 */
export function wholeLines(list, lines, app) {
  const more = h('button', {type: 'button', class: 'more-lines', hidden: true, onclick: () => list.scrollBy({top: list.clientHeight - 8, behavior: 'smooth'})});
  const one = {list, more, app, lines: () => lines().filter((line) => line.offsetHeight > 0)};
  kept.add(one);
  list.addEventListener('scroll', () => count(one), {passive: true});
  new MutationObserver(soon).observe(list, {childList: true, subtree: true, attributeFilter: ['hidden', 'open']});
  app.subscribe((state) => [state.language, state.presentation], soon);
  return more;
}

/** Where a line ends, from the top of what is seen. */
const bottom = (line, list) => line.getBoundingClientRect().bottom - list.getBoundingClientRect().top;

function fitAll() {
  for (const {list} of kept) for (const one of [list, list.closest('.card')]) if (one?.isConnected) resized.observe(one); // a capped list does not grow with its card
  for (const {list} of kept) cap(list, null);
  const whole = new Map([...kept].map((one) => [one, lastWhole(one)]));
  for (const [{list}, end] of whole) if (end) cap(list, end);
  for (const [one, end] of whole) if (end && grows(one.list)) refit(one); // what the others left empty is theirs
  for (const one of kept) count(one);
}

const grows = (list) => getComputedStyle(list.closest('.card') ?? list).flexGrow !== '0';

function refit(one) {
  cap(one.list, null);
  const end = lastWhole(one);
  if (end) cap(one.list, end);
}

/** How high the lines are that fit whole; null where all fit, or where too much would stay empty. */
function lastWhole({list, lines}) {
  const room = list.clientHeight;
  if (list.scrollHeight <= room + 1) return null;
  const end = Math.max(0, ...lines().map((line) => bottom(line, list) + list.scrollTop).filter((one) => one <= room + 0.5));
  return end > 0 && room - end < LOST ? Math.ceil(end) : null;
}

/** A list that has given way already gives way no further. */
function cap(list, height) {
  list.style.maxHeight = height === null ? '' : `${height}px`;
  const card = list.closest('.card');
  if (card && !card.matches('.desk .card')) card.style.flexShrink = height === null ? '' : 0;
}

function count({list, lines, more, app}) {
  const below = lines().filter((line) => bottom(line, list) > list.clientHeight + 2).length;
  more.hidden = below === 0;
  const words = below ? app.text.moreLines(below) : '';
  if (more.textContent !== words) more.textContent = words;
}
