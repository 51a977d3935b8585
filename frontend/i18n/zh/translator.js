// What the server says in English, said in another language: sentences by rules, [pattern, words with $1 …]. What no rule knows stays as it is.

/** A function that translates by rules: the whole, else the parts between semicolons, each for itself. A part in $1 … is translated in its turn. */
export function translator(rules, whole = {}) {
  const all = (words) => {
    if (typeof words !== 'string' || words === '') return words;
    const found = one(words);
    return found !== words || !words.includes('; ') ? found : words.split('; ').map(one).join('；');
  };
  const one = (words) => {
    if (whole[words] !== undefined) return whole[words];
    for (const [pattern, made] of rules) {
      const match = pattern.exec(words);
      if (match) return made.replace(/\$(\d)/g, (_, place) => (match[place] === undefined ? '' : all(match[place])));
    }
    return words;
  };
  return all;
}
