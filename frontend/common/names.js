// Names as symbols or words, and the short badges of fault channels.

import {withoutBlanks} from '../i18n/render.js';
import {hasWords, named, say, t} from '../i18n/words.js';

/** @import {Plant} from '../live/types.js' */

const PAIRS =
  'alpha α beta β gamma γ delta δ epsilon ε zeta ζ eta η theta θ iota ι kappa κ lambda λ mu μ nu ν xi ξ pi π rho ρ ' +
  'sigma σ tau τ upsilon υ phi φ chi χ psi ψ omega ω Gamma Γ Delta Δ Theta Θ Lambda Λ ' +
  'Xi Ξ Pi Π Sigma Σ Phi Φ Psi Ψ Omega Ω';

/** @type {{[name: string]: string}} Greek letters by name. */
export const GREEK = Object.fromEntries(
  PAIRS.split(' ')
    .map((word, place, all) => [word, all[place + 1]])
    .filter((_, place) => place % 2 === 0),
);

/** A name in a text: letters of any script, digits and underscores, as in the service's plants. */
export const NAME = /[\p{L}_][\p{L}\p{M}\p{N}_]*/gu;

/**
 * Letter (or word) and index of a name: theta1 → ['θ', '1'], gain_loss → ['gain loss', ''].
 * @param {string} name
 * @returns {[string, string]}
 */
export function split(name) {
  const match = /^(\p{L}+?)_?(\d+[a-z]?)$/u.exec(name) ?? /^(\p{L}+)_([\p{L}\d]+)$/u.exec(name);
  const [base, index] =
    match && (match[1].length === 1 || Object.hasOwn(GREEK, match[1])) ? [match[1], match[2]] : [name, ''];
  return [Object.hasOwn(GREEK, base) ? GREEK[base] : base.replaceAll('_', ' '), index];
}

/**
 * A name as plain text: theta3 → θ₃.
 * @param {string} name
 */
export function plain(name) {
  const [base, index] = split(name);
  if (/^\p{L}{2}/u.test(index)) return `${base}_${index}`;
  return base + [...index].map((digit) => '₀₁₂₃₄₅₆₇₈₉'[Number(digit)] ?? digit).join('');
}

/**
 * Whether a name is a symbol: a letter, perhaps with a short index; y_speed is a word.
 * @param {string} name
 */
export const symbolic = (name) => split(name)[0].length === 1 && !/^\p{L}{2}/u.test(split(name)[1]);

/**
 * A word of a name in the page's language, where the page has one for it: there is room for a few characters.
 * @param {string} text
 */
export function word(text) {
  const key = text.replaceAll(' ', '-');
  const code = `page.name.${key}`;
  return hasWords(code) ? t(code) : text;
}

/**
 * The beginning of a description, short enough for a label.
 * @param {Parameters<typeof named>[0]} prose
 */
export const brief = (prose) =>
  named(prose)
    .split(/[,;(，；（]/u)[0]
    .trim();

/**
 * The title of an item of a plant, else the beginning of its description.
 * @param {{title?: string, description?: string}} item
 */
export const titleOf = (item) => named(item.title) || brief(item.description);

/**
 * The page's name of a channel, output, input, signal or state: its symbol, or its title if the name is a word.
 * @param {string} name
 * @param {Plant | null} plant
 */
export function called(name, plant) {
  if (symbolic(name) || !plant) return plain(name);
  const {channels, outputs, inputs, signals, states, references = []} = plant;
  const item = [...channels, ...outputs, ...inputs, ...signals, ...references, ...states].find(
    (one) => one.name === name,
  );
  return (item && titleOf(item)) || plain(name);
}

/**
 * A message of the server, with the plant's names as the page calls them: theta1 and leak1 → θ₁ and leak in tank 1.
 * @param {Parameters<typeof say>[0]} message
 * @param {Plant | null} plant
 */
export function spoken(message, plant) {
  const names = plant
    ? [...plant.channels, ...plant.outputs, ...plant.inputs, ...plant.signals, ...(plant.references ?? [])].map(
        (one) => one.name,
      )
    : [];
  return withoutBlanks(say(message).replace(NAME, (part) => (names.includes(part) ? called(part, plant) : part)));
}

/**
 * With a capital letter at its beginning; a symbol stays as it is.
 * @param {string} words
 */
export const capital = (words) => words.replace(/^[a-z](?=[a-z ])/, (first) => first.toUpperCase());

/**
 * The badge of each channel, two or three characters that distinguish it from the others: θ₁, gl for gain_loss,
 * lv₁ and lk₁ for level1 and leak1.
 * @param {{name: string}[]} channels
 * @returns {Map<string, [string, string]>} name → [letters, index]
 */
export function badges(channels) {
  /** @type {Map<string, [string, string]>} */
  const badgeOf = new Map();
  /** @type {Map<string, string>} the part before the number → its letters */
  const words = new Map();
  for (const {name} of channels) {
    const [base, index] = split(name);
    if (base.length === 1) badgeOf.set(name, [base, index]);
    else words.set(numbered(name)[0], '');
  }
  for (const word of words.keys()) words.set(word, shortened(word, [...words.keys()]));
  for (const {name} of channels) {
    if (badgeOf.has(name)) continue;
    const [word, index] = numbered(name);
    badgeOf.set(name, [words.get(word) ?? word, index]);
  }
  return badgeOf;
}

/**
 * The part of a name before its number, and the number: level1 → ['level', '1'].
 * @param {string} name
 * @returns {[string, string]}
 */
function numbered(name) {
  const number = /\d*$/.exec(name)?.[0] ?? '';
  return [name.slice(0, name.length - number.length).replace(/_$/, ''), number];
}

/**
 * Initials of several words; of one word its first letter, and where others begin alike a consonant that they lack.
 * @param {string} word
 * @param {string[]} all
 */
function shortened(word, all) {
  if (word.includes('_'))
    return word
      .split('_')
      .map((part) => part[0])
      .join('')
      .slice(0, 3);
  const rivals = all.filter((other) => other !== word && other[0] === word[0] && !other.includes('_'));
  if (rivals.length === 0) return word[0];
  const consonants = [...word.slice(1)].filter((letter) => !'aeiou'.includes(letter));
  const own = consonants.find((letter) => rivals.every((other) => !other.slice(1).includes(letter)));
  return word[0] + (own ?? consonants[0] ?? word[1] ?? '');
}
