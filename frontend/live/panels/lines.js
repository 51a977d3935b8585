// Lists that end with a whole line: what does not fit is scrolled to, and the rim of the card says how many lines follow.

import {h} from '../../dom.js';

const LOST = 80; // px of room that may stay empty below the last whole line; a taller one is cut after all

/**
 * Keep a scrolling list whole. `lines()` are its lines from above; what it returns says how many are out of sight below, and goes into the card.
 * @returns {HTMLButtonElement}
 */
export function wholeLines(list, lines, app) {
  const more = h('button', {type: 'button', class: 'more-lines', hidden: true, onclick: () => list.scrollBy({top: list.clientHeight - 8, behavior: 'smooth'})});
  let asked = 0;
  const soon = () => { asked ||= requestAnimationFrame(() => { asked = 0; fit(); }); };
  const seen = () => lines().filter((line) => line.offsetHeight > 0);
  const bottom = (line) => line.getBoundingClientRect().bottom - list.getBoundingClientRect().top;
  const fit = () => {
    list.style.maxHeight = '';
    const room = list.clientHeight;
    if (list.scrollHeight > room + 1) {
      const whole = Math.max(0, ...seen().map((line) => bottom(line) + list.scrollTop).filter((end) => end <= room + 0.5));
      if (whole > 0 && room - whole < LOST) list.style.maxHeight = `${Math.ceil(whole)}px`;
    }
    count();
  };
  const count = () => {
    const below = seen().filter((line) => bottom(line) > list.clientHeight + 2).length;
    more.hidden = below === 0;
    const words = below ? app.text.moreLines(below) : '';
    if (more.textContent !== words) more.textContent = words;
  };
  list.classList.add('whole-lines');
  list.addEventListener('scroll', count, {passive: true});
  new ResizeObserver(soon).observe(list);
  new MutationObserver(soon).observe(list, {childList: true, subtree: true, characterData: true, attributeFilter: ['hidden', 'open', 'class']});
  app.subscribe((state) => [state.language, state.presentation], soon);
  addEventListener('resize', soon);
  return more;
}
