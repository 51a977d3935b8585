// The page's names of kinds of observers.

import {hasWords, named, t} from '../i18n/words.js';

/**
 * The short name of a kind where the page has one, else the title that the catalogue of observers gives.
 * @param {{id: string, title: string}} kind
 */
export function kindName({id, title}) {
  const code = `page.observers.type.${id}`;
  return hasWords(code) ? t(code) : named(title);
}
