// What still comes in English only: names and prose of the kinds of observers, and what the outputs show of states and faults. Everything else
// has a code.

import {translator} from './translator.js';
import {catalogue} from './catalogue.js';
import {diagnosisRules} from './diagnosis-text.js';
import {names} from './library-names.js';
import {prose} from './prose.js';

/** @type {{[words: string]: string}} */
const known = {...prose, ...catalogue, ...names};

/** The Chinese of a name or of prose; a text that has none stays as it is. @param {string | null | undefined} words */
export const named = (words) => (words ? (known[words] ?? words) : words);

/** The Chinese of a sentence. */
export const said = translator(diagnosisRules, known);
