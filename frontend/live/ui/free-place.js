// Places for notices that cover nothing: the empty middle of the header, else over the scope's legend.

import {query} from '../../common/dom.js';

const WIDE = '(min-width: 1180px)'; // narrower pages have their own places for it (narrow.css)
const LEAST = 300; // px of the header's middle in which text may wrap; less where the legend's place is taken
const ROUNDING = 1; // px: an element as wide as its room may measure a fraction more

/**
 * Put an element in the first place with room for it. While presenting, and on narrow pages, the style sheet places it.
 * @param {HTMLElement} element
 * @param {{breaks?: boolean, taken?: boolean, crowded?: boolean, narrow?: (on: boolean) => void}} [options]
 *   breaks: its text may wrap; taken: the header holds something else; crowded: the legend's place does; narrow: makes
 * it
 *   narrower, for a header without room
 */
export function stand(element, {breaks = false, taken = false, crowded = false, narrow = () => {}} = {}) {
  Object.assign(element.style, {left: '', top: '', bottom: '', maxWidth: '', transform: ''});
  narrow(false);
  if (!matchMedia(WIDE).matches || document.documentElement.classList.contains('presentation')) return;
  const gap = document.querySelector('.top .grow')?.getBoundingClientRect();
  const header = query('.top').getBoundingClientRect();
  const room = gap ? gap.width - 16 : 0;
  const fits = () => element.getBoundingClientRect().width <= room + ROUNDING;
  if (breaks && room > (crowded ? 0 : LEAST)) element.style.maxWidth = `${room}px`;
  if (!taken && !fits()) narrow(true);
  const inHeader = () => fits() && element.offsetHeight <= header.height;
  if (gap && !taken && inHeader())
    put(element, gap.left + gap.width / 2, header.top + (header.height - element.offsetHeight) / 2);
  else {
    narrow(false);
    const scope = query('#scope').getBoundingClientRect();
    element.style.maxWidth = `${scope.width - 16}px`;
    const plots = query('.plots').getBoundingClientRect();
    const above = plots.top - element.offsetHeight - 2;
    put(element, scope.left + scope.width / 2, above >= header.bottom ? above : plots.top + 8);
  }
}

/**
 * @param {HTMLElement} element
 * @param {number} middle
 * @param {number} top
 */
function put(element, middle, top) {
  Object.assign(element.style, {
    left: `${middle - element.offsetWidth / 2}px`,
    top: `${top}px`,
    bottom: 'auto',
    transform: 'none',
  });
}

/**
 * Whether the first element of a selector is shown within the header (true), below it (false), or not at all (null).
 * @param {string} selector
 */
export function isInHeader(selector) {
  const element = document.querySelector(selector);
  if (!element) return null;
  return element.getBoundingClientRect().top < query('.top').getBoundingClientRect().bottom;
}

/**
 * Call `again` when the room may have changed.
 * @param {() => void} again
 */
export function watchRoom(again) {
  const watcher = new ResizeObserver(again);
  const begin = () => {
    for (const one of document.querySelectorAll('.top .grow, #scope')) watcher.observe(one);
  };
  if (document.querySelector('.top .grow')) begin();
  else {
    const header = new MutationObserver(() => {
      if (!document.querySelector('.top .grow')) return;
      header.disconnect();
      begin();
    });
    header.observe(query('#panel-header'), {childList: true});
  }
}
