// A sentence that explains a symbol: shown beside it while the pointer rests on it, it has the focus, or it was tapped.

import {h} from '../common/dom.js';

const REST = 300; // ms that the pointer rests on a symbol before its sentence is shown
const LEAVE = 200; // ms in which the pointer may move from the symbol into the sentence
const GAP = 6; // pixels between them

const bubble = h('div', {id: 'explanation', role: 'tooltip', class: 'explanation', hidden: true});
/** @type {HTMLElement | null} */
let explained = null;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/**
 * Explain an element, which then can be focused. The sentence is asked for when it is shown.
 * @param {HTMLElement} element
 * @param {() => string} sentence
 * @param {boolean} [focusable]   false where the same symbol can be focused nearby
 */
export function explain(element, sentence, focusable = true) {
  if (focusable) element.tabIndex = 0;
  element.classList.add('explained');
  element.addEventListener('pointerenter', ({pointerType}) => {
    if (pointerType === 'mouse') later(() => show(element, sentence()), REST);
  });
  element.addEventListener('pointerleave', () => later(hide, LEAVE));
  element.addEventListener('focus', () => show(element, sentence()));
  element.addEventListener('blur', hide);
}

/**
 * @param {() => void} act
 * @param {number} wait
 */
function later(act, wait) {
  clearTimeout(timer);
  timer = setTimeout(act, wait);
}

/**
 * @param {HTMLElement} element
 * @param {string} sentence
 */
function show(element, sentence) {
  clearTimeout(timer);
  hide();
  if (!element.isConnected) return;
  if (!bubble.isConnected) attach();
  explained = element;
  element.setAttribute('aria-describedby', bubble.id);
  bubble.textContent = sentence;
  bubble.hidden = false;
  const at = element.getBoundingClientRect();
  const {width, height} = bubble.getBoundingClientRect();
  const above = at.top - height - GAP;
  bubble.style.left = `${Math.max(GAP, Math.min(at.left, innerWidth - width - GAP))}px`;
  bubble.style.top = `${above >= GAP ? above : at.bottom + GAP}px`;
}

function hide() {
  clearTimeout(timer);
  explained?.removeAttribute('aria-describedby');
  explained = null;
  bubble.hidden = true;
}

/** Add the bubble to the page: the pointer may enter it, Esc closes it, and it goes where the symbol moves away. */
function attach() {
  document.body.append(bubble);
  bubble.addEventListener('pointerenter', () => clearTimeout(timer));
  bubble.addEventListener('pointerleave', hide);
  addEventListener('scroll', hide, {capture: true, passive: true});
  addEventListener('resize', hide);
  for (const event of ['pointermove', 'focusin']) {
    addEventListener(event, () => {
      if (explained && !explained.isConnected) hide(); // the symbol was drawn anew
    });
  }
  addEventListener(
    'keydown',
    (event) => {
      if (event.key !== 'Escape' || bubble.hidden) return;
      event.stopImmediatePropagation();
      hide();
    },
    {capture: true},
  );
}
