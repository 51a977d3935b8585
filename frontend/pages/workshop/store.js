// The state of the workshop. Views subscribe to parts of it.

/** @import {ShopState, ShopStore} from './types.js' */

/**
 * @param {ShopState} begin
 * @returns {ShopStore}
 */
export function createStore(begin) {
  let state = begin;
  /** @type {{select: (state: ShopState) => unknown, show: (state: ShopState) => void, last: unknown}[]} */
  const views = [];
  return {
    get state() {
      return state;
    },
    set(changes) {
      state = {...state, ...changes};
      for (const view of views) {
        const next = view.select(state);
        if (same(next, view.last)) continue;
        view.last = next;
        view.show(state);
      }
    },
    subscribe(select, show) {
      views.push({select, show, last: select(state)});
      show(state);
    },
  };
}

/** @param {unknown} a @param {unknown} b */
function same(a, b) {
  if (!Array.isArray(a) || !Array.isArray(b)) return Object.is(a, b);
  return a.length === b.length && a.every((item, place) => Object.is(item, b[place]));
}

/** Whether the text differs from what was opened or saved. @param {ShopState} state */
export const isChanged = ({text, source}) => text !== source.text;

/** The id in the text, also of a text with errors. @param {string} text */
export function idIn(text) {
  const found = /^\s*(?:\{\s*)?["']?id["']?\s*:\s*["']?([a-z0-9][a-z0-9-]{0,63})\b/mu.exec(text);
  return found ? found[1] : '';
}

/** The errors of the present text that keep it from being simulated. @param {ShopState} state */
export const errorsOf = ({check}) => check?.errors.filter((error) => error.severity === 'error') ?? [];

/** Whether the plant can be simulated as it is. @param {ShopState} state */
export const isReady = (state) => !state.checking && state.check !== null && state.check.valid;

/** The kinds of observers that are ticked. @param {ShopState} state @returns {readonly string[]} */
export function chosenKinds({chosen, ranking, good}) {
  if (chosen) return chosen;
  if (ranking)
    return ranking
      .filter((one) => one.possible)
      .slice(0, 2)
      .map((one) => one.kind);
  return good?.plant?.channels.length ? ['adaptive-kalman-discrete', 'joint-ekf'] : [];
}
