// The editor's card: CodeMirror where it is installed, else a plain field with the same checks.

import {codeEditor} from './code-editor.js';
import {plainEditor} from './plain-editor.js';

/** @import {Editor, EditorEvents} from '../types.js' */

const BUNDLE = new URL('../../../vendor/codemirror.js', import.meta.url).href;

/**
 * @param {string} text
 * @param {EditorEvents} events
 * @returns {Promise<Editor>}
 */
export async function createEditor(text, events) {
  try {
    return codeEditor(await import(BUNDLE), text, events);
  } catch {
    return plainEditor(text, events); // set-up could not bundle CodeMirror, or the file was not delivered
  }
}
