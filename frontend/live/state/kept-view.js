// What this tab shows beside the strips of a session, its phase planes and the full comparison: they come back when the
// page is loaded again, and when the browser's Back leads to the session.

/** @import {App, State} from '../types.js' */

const VIEWS = 'thetascope.views';
const MOST = 8; // sessions that are remembered

/** @typedef {Pick<State, 'planes' | 'table'>} View */

/** @returns {[session: string, view: View][]} the newest last */
function all() {
  try {
    const known = JSON.parse(sessionStorage.getItem(VIEWS) ?? '[]');
    return Array.isArray(known) ? known : [];
  } catch {
    return [];
  }
}

/** @param {string} session @param {View} view */
function write(session, view) {
  try {
    const others = all().filter(([id]) => id !== session);
    const nothing = view.planes.length === 0 && !view.table;
    sessionStorage.setItem(VIEWS, JSON.stringify(nothing ? others : [...others, [session, view]].slice(-MOST)));
  } catch {
    /* private windows keep nothing */
  }
}

/** @param {App} app */
export function keepView(app) {
  app.subscribe(
    ({session, planes, table}) => [session, planes, table],
    ([session, planes, table], before) => {
      if (session === null) return;
      const known = before?.[0] === session ? undefined : all().find(([id]) => id === session);
      if (known) app.store.dispatch({type: 'set', planes: known[1].planes, table: known[1].table});
      else write(session, {planes, table});
    },
  );
}
