// What the library and the server say, in Chinese.

import {translator} from './said.js';
import {catalogue} from './zh-catalogue.js';
import {checkNames, checkRules} from './zh-checks.js';
import {diagnosisRules} from './zh-diagnosis.js';
import {names} from './zh-names.js';
import {prose} from './zh-prose.js';
import {refusalRules} from './zh-refusals.js';

const known = {...prose, ...catalogue, ...names};

/** What the library calls things; what is not of the library stays as it is. */
export const named = (words) => known[words] ?? words;

/** What the server says of a check, or why it refuses. */
export const said = translator([...checkRules, ...refusalRules, ...diagnosisRules], {...known, ...checkNames});
