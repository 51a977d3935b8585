// The notes of a session and their words. They are part of its spec: saved, shared and forked with it.

import {seconds} from '../../widgets/number-format.js';
import {t} from '../../i18n/words.js';

/** @import {Note, State} from '../types.js' */

/** @type {Note[]} */
const NONE = [];

/** @param {Pick<State, 'spec'>} state */
export const notesOf = ({spec}) => spec?.notes ?? NONE;

/**
 * A note's moment in s, as the clock shows it.
 * @param {Pick<Note, 't'>} note
 * @param {Pick<State, 'record'>} state
 */
export const momentOf = (note, {record}) => seconds(note.t, record >= 1 ? 1 : 0.1);

/**
 * A note in a line: "Note at 12.5 s: the EKF overshoots", or "Bookmark at 12.5 s".
 * @param {Note} note
 * @param {Pick<State, 'record'>} state
 */
export function lineOf(note, state) {
  const at = momentOf(note, state);
  return note.text ? t('page.notes.line', {t: at, text: note.text}) : t('page.notes.bookmark', {t: at});
}

/** An id that no other note has. */
export const newId = () =>
  `n${Array.from(crypto.getRandomValues(new Uint8Array(10)), (byte) => (byte % 36).toString(36)).join('')}`;
