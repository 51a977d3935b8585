// Notes and bookmarks: begin one at the moment shown, change, remove, go there.

import {momentOf, newId, notesOf} from './note-words.js';

/** @import {Actions, App, Command, Note} from '../types.js' */

/**
 * @param {App} app
 * @param {(command: Command) => Promise<unknown>} send   shows a refusal; gives null then
 * @returns {Actions['notes']}
 */
export function noteActions(app, send) {
  /** @param {Note | null} noting */
  const open = (noting) => app.store.dispatch({type: 'set', noting});
  const may = () => {
    const {role, connection} = app.state;
    if (role === 'view') app.act.tell({code: 'page.notice.view-only'});
    return role === 'control' && connection === 'live';
  };
  /** @param {Note} note */
  const keep = async (note) => (await send({type: 'add-note', note})) !== null;
  return {
    begin() {
      const t = Number((app.state.looking ?? app.samples.now).toPrecision(12));
      if (may() && Number.isFinite(t)) open({id: newId(), t, text: ''});
    },
    edit(note) {
      if (may()) open(note);
    },
    close: () => open(null),
    keep,
    async remove(note) {
      if (!may()) return;
      if (app.state.noting?.id === note.id) open(null);
      if ((await send({type: 'remove-note', note: note.id})) === null) return;
      app.act.tell(
        {code: 'page.notes.removed', args: {t: momentOf(note, app.state)}},
        {action: {message: {code: 'page.action.undo'}, act: () => void keep(note)}},
      );
    },
    visit(note) {
      app.act.look(note.t < app.samples.now ? note.t : null);
    },
    find: (id) => notesOf(app.state).find((note) => note.id === id) ?? null,
  };
}
