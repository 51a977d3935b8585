// An equation in a narrow card: it is broken before a term, and set smaller only if a single term is too long.

import {h} from '../../../common/dom.js';
import {focusWhenScrolling} from '../../../common/scroll-focus.js';
import {mathml} from '../../../widgets/equations.js';

const SMALLEST = 0.7; // of the usual size of type; a term that is still too long is scrolled
const UNIT = 48; // px that a unit beside an equation needs
const INDENT = 18; // px of the lines after the first

/**
 * An equation as the pieces between which a line may end: the left side with the first term, then each further term
 * with its sign.
 * @param {string} text   MathML
 */
export function equationLine(text) {
  const math = /** @type {Element} */ (mathml(text));
  /** @type {Element[]} */
  const pieces = [];
  let equals = false;
  for (const node of flat(math.firstElementChild ?? math)) {
    const sign = node.localName === 'mo' && /^[+−-]$/.test(node.textContent ?? '');
    if (!pieces.length || (equals && (sign || node.classList.contains('fault')) && filled(pieces.at(-1)))) {
      const piece = /** @type {Element} */ (math.cloneNode(false));
      piece.append(document.createElementNS(math.namespaceURI, 'mrow'));
      pieces.push(piece);
    }
    if (sign && pieces.length > 1) node.setAttribute('form', 'infix'); // at the start of a piece it would be a prefix
    equals ||= node.textContent === '=';
    pieces.at(-1)?.firstElementChild?.append(node);
  }
  return h('span', {class: 'line'}, pieces);
}

/** The parts of the outermost sum. @param {Element} row @returns {Element[]} */
function flat(row) {
  return [...row.children].flatMap((child) => (summed(child) ? flat(child) : [child]));
}

/** Whether an element is a sum that stands by itself, without parentheses. @param {Element} element */
function summed(element) {
  return (
    element.localName === 'mrow' &&
    !element.classList.contains('fault') &&
    [...element.children].some((child) => child.localName === 'mo' && /^[+−]$/.test(child.textContent ?? '')) &&
    ![...element.children].some((child) => child.hasAttribute('fence') || child.textContent === '(')
  );
}

/** Whether a piece has more than the left side. @param {Element | undefined} piece */
function filled(piece) {
  return piece?.textContent !== '' && !piece?.textContent?.endsWith('=');
}

/**
 * Break equations that are too long for the card, and set terms that still are in smaller type. A unit is shown where
 * there is room beside it.
 * @param {HTMLElement} box
 */
export function fitted(box) {
  const lines = /** @type {NodeListOf<HTMLElement>} */ (box.querySelectorAll('.line'));
  new ResizeObserver(() => {
    const room = box.clientWidth;
    for (const line of lines) {
      line.style.fontSize = '';
      line.classList.remove('broken');
    }
    const long = [...lines].filter((line) => line.offsetWidth > room);
    for (const line of long) line.classList.add('broken');
    const shares = long.map((line) => (room - INDENT) / Math.max(1, ...[...line.children].map(width)));
    for (const [place, line] of long.entries())
      if (shares[place] < 1) line.style.fontSize = `${Math.max(SMALLEST, 0.98 * shares[place])}em`;
    for (const line of lines) {
      const unit = /** @type {HTMLElement} */ (line.nextElementSibling);
      if (unit.className === 'soft') unit.hidden = line.classList.contains('broken') || line.offsetWidth > room - UNIT;
    }
  }).observe(box);
  return focusWhenScrolling(box);
}

/** @param {Element} element */
const width = (element) => element.getBoundingClientRect().width;
