// What the symbols in a lesson's sentences mean, shown beside them on hover and focus.

import {explain} from '../../widgets/explain.js';
import {t} from '../../i18n/words.js';

const HAT = '\u0302';

/** @type {Record<string, () => string>} */
const MEANINGS = {
  y: () => t('page.symbol.y'),
  [`y${HAT}`]: () => t('page.symbol.y-hat'),
  x: () => t('page.symbol.x'),
  [`x${HAT}`]: () => t('page.symbol.x-hat'),
  u: () => t('page.symbol.u'),
  ρ: () => t('page.symbol.gain'),
  K: () => t('page.symbol.gain'),
  L: () => t('page.symbol.gain'),
  H: () => t('page.symbol.gain'),
  θ: () => t('page.glossary.fault.meaning'),
  [`θ${HAT}`]: () => t('page.glossary.estimate.meaning'),
  λ: () => t('page.symbol.lambda'),
  λmin: () => t('page.explain.excitation'),
};

/**
 * Explain the symbols of a card. The keyboard reaches each of them once, and none inside an answer, which is a label.
 * @param {HTMLElement} card
 */
export function explainSymbols(card) {
  const reached = new Set();
  for (const element of card.querySelectorAll('[data-symbol]')) {
    if (!(element instanceof HTMLElement)) continue;
    const name = element.dataset.symbol ?? '';
    const meaning = MEANINGS[name];
    if (!meaning) continue;
    const focusable = !reached.has(name) && !element.closest('label');
    if (focusable) {
      reached.add(name);
      element.setAttribute('role', 'term');
      element.dataset.keep = `symbol-${name}`;
    }
    explain(element, meaning, focusable);
  }
}
