// The facts of the time that is looked back to, as the server had them then (GET /api/sessions/{id}/facts).

import {get} from '../../common/api.js';

/** @import {App, State} from '../types.js' */
/** @import * as service from '../../types/service.js' */

const REST = 120; // ms that the time must stay before it is asked for, while the timeline is dragged

/**
 * The time that is looked back to in s: chosen on the timeline, or the end of a zoom in the past. null: the present.
 * @param {Pick<State, 'looking' | 'selection' | 'record'>} state
 * @param {number} now
 */
export function momentOf({looking, selection, record}, now) {
  const at = looking ?? selection?.[1] ?? null;
  return at === null || at > now - 1.5 * record ? null : at;
}

/**
 * Keep `state.past` at the time that is looked back to.
 * @param {App} app
 */
export function watchPast(app) {
  let asked = 0; // number of the newest request: answers to earlier ones are dropped
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;
  const ask = async () => {
    const {state} = app;
    const at = momentOf(state, app.samples.now);
    const number = (asked += 1);
    if (at === null || state.session === null) {
      if (state.past !== null) app.store.dispatch({type: 'set', past: null});
      return;
    }
    /** @type {service.Facts | null} */
    const past = await get(`/api/sessions/${encodeURIComponent(state.session)}/facts?t=${at}`).catch(() => null);
    if (number === asked) app.store.dispatch({type: 'set', past});
  };
  app.subscribe(
    (state) => [state.looking, state.selection, state.session, state.epoch, state.faults, state.alarms],
    () => {
      clearTimeout(waiting);
      if (momentOf(app.state, app.samples.now) === null) ask();
      else waiting = setTimeout(ask, REST);
    },
  );
}
