// The verdicts of a check, in the order in which they are counted, and their words.

import {t} from '../i18n/words.js';

export const VERDICTS = ['holds', 'fails', 'cannot tell'];

/** @param {string} verdict */
export function verdictWords(verdict) {
  const key = verdict.replaceAll(' ', '-');
  return t(`page.observers.verdict.${key}`);
}
