// Messages of the service as sentences of the page of records.

import {say, t} from '../../i18n/words.js';

const WORD = /^(?:\p{Ll}(?=\p{Ll})|a(?= ))/u; // not a symbol: y, q1
const END = /[.?!。？！]$/u;

/**
 * A message with a capital letter and a full stop; a symbol at its beginning stays as it is.
 * @param {Parameters<typeof say>[0]} message
 */
export function sentence(message) {
  const words = say(message);
  if (words === '') return '';
  return `${words.replace(WORD, (letter) => letter.toUpperCase())}${END.test(words) ? '' : t('page.text.stop')}`;
}
