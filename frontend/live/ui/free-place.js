// Places for notices that cover neither the legend nor a button: the empty middle of the header, else the gap between
// the bar and the legend, else the curves. On narrow pages the lowest place without a button.

import {query} from '../../common/dom.js';

const WIDE = '(min-width: 1180px)';
const PRESENTS = '(min-width: 960px)'; // as in presentation.css
const LEAST = 240; // px of the header's middle in which text may wrap; less where the gap below the bar is taken
const STEP = 6; // px between the places that are tried on a narrow page
const KEPT = 'button, a[href], input, select, summary, textarea, [role=button], [role=slider], .legend, .choice';
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
  element.classList.remove('slim');
  narrow(false);
  const presents = document.documentElement.classList.contains('presentation') && matchMedia(PRESENTS).matches;
  if (presents && element.matches('.choice')) return; // its style sheet places it
  if (!presents && !matchMedia(WIDE).matches) {
    if (getComputedStyle(element).position === 'fixed') standLow(element);
    return;
  }
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
    standBelow(element, crowded);
  }
}

/**
 * Put an element between the bar and the legend, where a line has room, else over the lower end of the curves.
 * @param {HTMLElement} element
 * @param {boolean} crowded   something else is in the gap
 */
function standBelow(element, crowded) {
  const scope = query('#scope').getBoundingClientRect();
  const top = Math.max(...[query('.rail'), query('#transport')].map((one) => one.getBoundingClientRect().bottom));
  const heads = [...query('.scope-head').children].map((one) => one.getBoundingClientRect());
  const bottom = Math.min(...heads.filter(({width}) => width > 0).map((box) => box.top));
  element.style.maxWidth = `${scope.width + 12}px`;
  element.classList.add('slim');
  const middle = scope.left + scope.width / 2;
  if (!crowded && element.offsetHeight <= bottom - top) {
    put(element, middle, top + (bottom - top - element.offsetHeight) / 2);
    return;
  }
  element.classList.remove('slim');
  element.style.maxWidth = `${scope.width - 16}px`;
  put(element, middle, Math.max(8, query('.time-axis').getBoundingClientRect().top - element.offsetHeight - 4));
}

/**
 * Put an element as low on a narrow page as it lies on no button, else where it covers the least.
 * @param {HTMLElement} element
 */
function standLow(element) {
  const kept = [...document.querySelectorAll(KEPT)]
    .filter((one) => !element.contains(one) && one.checkVisibility({opacityProperty: true, visibilityProperty: true}))
    .map((one) => one.getBoundingClientRect())
    .filter((box) => box.bottom > 0 && box.top < innerHeight && box.width > 1);
  const {left, right, height} = element.getBoundingClientRect();
  /** @param {number} top */
  const covered = (top) =>
    kept
      .map(
        (box) =>
          Math.max(0, Math.min(box.right, right) - Math.max(box.left, left)) *
          Math.max(0, Math.min(box.bottom, top + height) - Math.max(box.top, top)),
      )
      .reduce((sum, one) => sum + one, 0);
  let best = {top: innerHeight - height - 8, area: Infinity};
  for (let top = best.top; top >= 4 && best.area > 0; top -= STEP) {
    const area = covered(top);
    if (area < best.area) best = {top, area};
  }
  Object.assign(element.style, {top: `${best.top}px`, bottom: 'auto'});
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
  addEventListener('scroll', () => requestAnimationFrame(again), {passive: true}); // narrow pages
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
