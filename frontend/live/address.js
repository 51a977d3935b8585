// The address of the page: it reopens what is seen, and its entry of the browser's history keeps the session.

import {addressOf} from './actions.js';
import {kept} from './net/session.js';

/** @import {App} from './types.js' */

/**
 * @typedef {object} Address
 * @property {() => Promise<void>} write   write it now
 * @property {() => void} soon             write it a moment after the last of several changes
 * @property {<T>(move: () => Promise<T>) => Promise<T>} arrive
 */

const PAUSE = 400; // ms from a change to the address that shows it
const PERIOD = 5000; // ms between updates of the address while time runs
const UNLOAD = 30_000; // ms after which a page that was not left after all writes its address again

/**
 * Keep the address up to date.
 * @param {App} app
 * @param {() => string | null} token   the present one of the session
 * @returns {Address}
 */
export function keepAddress(app, token) {
  /** @type {number | null} */
  let waiting = null;
  let written = -1; // rows when the address was last written: single steps move the time, too
  let arriving = 0; // moves to another session that are under way: the address is that session's already
  let leaving = -Infinity; // when the browser began to leave the page, or to load it again

  // An address that changes while the page is loaded again costs the entry its state: the browser gives it back
  // only where the address is still the one that it asked for.
  const stays = () => arriving === 0 && performance.now() - leaving > UNLOAD;

  async function write() {
    if (waiting !== null) clearTimeout(waiting);
    waiting = null;
    written = app.samples.rows;
    const {state} = app;
    if (state.role !== 'control' || !state.spec || state.connection !== 'live') return;
    const address = await addressOf(app);
    if (state.session === null || app.state.session !== state.session || !stays()) return;
    history.replaceState({session: state.session}, '', `/${address}`);
    kept.write({
      id: state.session,
      token: token(),
      address,
      experiment: state.experiment,
      plain: state.begunPlain,
      parent: state.parent,
    });
  }

  function soon() {
    waiting ??= setTimeout(write, PAUSE);
  }

  setInterval(() => app.samples.rows !== written && soon(), PERIOD);
  addEventListener('beforeunload', () => {
    leaving = performance.now();
  });
  addEventListener('pagehide', () => {
    const mine = kept.read(); // a page that is loaded again knows its session by its address
    if (mine?.id === app.state.session) kept.write({...mine, address: location.search + location.hash});
  });
  addEventListener('pageshow', () => {
    leaving = -Infinity; // shown again from the browser's cache
  });

  return {
    write,
    soon,
    /**
     * Move to another session, whose entry of the browser's history is the present one. Until it is joined, the
     * session that is being left may not write its own address there.
     */
    async arrive(move) {
      arriving += 1;
      try {
        return await move();
      } finally {
        arriving -= 1;
      }
    },
  };
}
