// What the server says in English, said in another language: sentences by rules, [pattern, words with $1 …]. What no rule knows stays as it is.

/** @typedef {[pattern: RegExp, words: string]} Rule */

/**
 * A function that translates by rules: the whole, else the parts between semicolons, each for itself. A part in $1 … is translated in its turn.
 * @param {Rule[]} rules
 * @param {{[words: string]: string}} [whole]
 */
export function translator(rules, whole = {}) {
  /** @param {string} words @returns {string} */
  const all = (words) => {
    if (typeof words !== 'string' || words === '') return words;
    const found = one(words);
    return found !== words || !words.includes('; ') ? found : words.split('; ').map(one).join('；');
  };
  /** @param {string} words @returns {string} */
  const one = (words) => {
    if (whole[words] !== undefined) return whole[words];
    for (const [pattern, made] of rules) {
      const match = pattern.exec(words);
      if (match)
        return made.replace(/\$(\d)/g, (_, place) =>
          match[Number(place)] === undefined ? '' : all(match[Number(place)]),
        );
    }
    return words;
  };
  return all;
}
