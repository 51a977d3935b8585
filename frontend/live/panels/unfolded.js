// Cards that unfold over the panels below them.

/** @import {App} from '../types.js' */

/**
 * Fold a card by Escape, which returns the focus to its button, and when a fault site is chosen in the plant.
 * @param {HTMLElement} element
 * @param {App} app
 * @param {{readonly open: boolean, readonly toggle: HTMLElement, unfold: (on: boolean) => void}} card
 * @param {() => boolean} [stays]   whether it is unfolded for good now
 */
export function foldsAway(element, app, card, stays = () => false) {
  element.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !card.open || event.defaultPrevented || stays()) return;
    event.preventDefault();
    card.unfold(false);
    card.toggle.focus();
  });
  app.subscribe(
    (state) => state.site,
    (site) => {
      if (site && card.open && !stays()) card.unfold(false);
    },
  );
}
