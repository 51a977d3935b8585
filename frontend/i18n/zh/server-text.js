// What the library and the server say, in Chinese.

import {translator} from './translator.js';
import {catalogue} from './catalogue.js';
import {checkNames, checkRules} from './checks.js';
import {diagnosisRules} from './diagnosis-text.js';
import {names} from './library-names.js';
import {prose} from './prose.js';
import {refusalRules} from './refusals.js';

/** @type {{[words: string]: string}} */
const known = {...prose, ...catalogue, ...names};

/** @param {string | null | undefined} words */
export const named = (words) => (words ? (known[words] ?? words) : words);

/** What the server says of a check, or why it refuses. */
export const said = translator([...checkRules, ...refusalRules, ...diagnosisRules], {...known, ...checkNames});
