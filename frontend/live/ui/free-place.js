// Where something may stand for a while and cover nothing that is looked at: in the empty middle of the header, else over the scope's legend.

import {query} from '../../common/dom.js';

const WIDE = '(min-width: 1180px)'; // narrower pages have their own places for it (live.css)
const LEAST = 300; // px of the header's middle from which on words may break in it

/**
 * Put an element there; `narrow` may make it narrower where it does not fit. While presenting, and on narrow pages, the style sheet places it.
 * @param {HTMLElement} element
 * @param {{breaks?: boolean, taken?: boolean, narrow?: (on: boolean) => void}} [options]
 */
export function stand(element, {breaks = false, taken = false, narrow = () => {}} = {}) {
  Object.assign(element.style, {left: '', top: '', bottom: '', maxWidth: '', transform: ''});
  narrow(false);
  if (!matchMedia(WIDE).matches || document.documentElement.classList.contains('presentation')) return;
  const gap = document.querySelector('.top .grow')?.getBoundingClientRect();
  const header = query('.top').getBoundingClientRect();
  const room = gap ? gap.width - 16 : 0;
  const fits = () => element.offsetWidth <= room;
  if (breaks && room > LEAST) element.style.maxWidth = `${room}px`;
  if (!taken && !fits()) narrow(true);
  if (gap && !taken && fits())
    put(element, gap.left + gap.width / 2, header.top + (header.height - element.offsetHeight) / 2);
  else {
    narrow(false);
    const scope = query('#scope').getBoundingClientRect();
    element.style.maxWidth = `${scope.width - 16}px`;
    const plots = query('.plots').getBoundingClientRect();
    put(element, scope.left + scope.width / 2, plots.top - element.offsetHeight - 2);
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
 * Whether something stands in the header already.
 * @param {string} selector
 */
export const standsInHeader = (selector) =>
  (document.querySelector(selector)?.getBoundingClientRect().top ?? Infinity) <
  query('.top').getBoundingClientRect().bottom;

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
