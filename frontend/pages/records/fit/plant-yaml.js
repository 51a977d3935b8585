// A plant as YAML: maps and lists in blocks, small ones in one line, texts in quotes where YAML needs them. Pure.

const PLAIN = /^[\p{L}_][\p{L}\p{N}_ ./³²⁻¹·°-]*$/u;
const WORDS = new Set(['true', 'false', 'yes', 'no', 'on', 'off', 'null', 'y', 'n', '~']);
const WIDTH = 110;

/**
 * The text of a value, with a newline at its end. Fields that are null, empty text or empty are left out.
 * @param {unknown} value
 */
export const yamlOf = (value) => `${block(pruned(value), '').replace(/^\n/u, '')}\n`;

/** @param {unknown} value @returns {unknown} */
function pruned(value) {
  if (Array.isArray(value)) return value.map(pruned);
  if (value === null || typeof value !== 'object') return value;
  const kept = Object.entries(value)
    .map(([key, item]) => /** @type {[string, unknown]} */ ([key, pruned(item)]))
    .filter(([key, item]) => key === 'unit' || !empty(item));
  return Object.fromEntries(kept);
}

/** @param {unknown} value */
const empty = (value) =>
  value === null || value === '' || (typeof value === 'object' && Object.keys(value).length === 0);

/** @param {unknown} value @param {string} indent @returns {string} */
function block(value, indent) {
  if (value === null || typeof value !== 'object') return ` ${scalar(value)}`;
  const short = flow(value);
  if (indent !== '' && indent.length + short.length < WIDTH) return ` ${short}`;
  if (Array.isArray(value)) return value.map((item) => `\n${indent}-${block(item, `${indent}  `)}`).join('');
  return Object.entries(value)
    .map(([key, item]) => `\n${indent}${scalar(key)}:${block(item, `${indent}  `)}`)
    .join('');
}

/** @param {unknown} value @returns {string} */
function flow(value) {
  if (Array.isArray(value)) return `[${value.map(flow).join(', ')}]`;
  if (value === null || typeof value !== 'object') return scalar(value);
  const pairs = Object.entries(value).map(([key, item]) => `${scalar(key)}: ${flow(item)}`);
  return `{${pairs.join(', ')}}`;
}

/** @param {unknown} value */
function scalar(value) {
  if (typeof value !== 'string') return typeof value === 'number' ? numeral(value) : String(value);
  return PLAIN.test(value) && !WORDS.has(value.toLowerCase()) && !value.endsWith(' ') ? value : JSON.stringify(value);
}

/**
 * A number that YAML 1.1 reads as one, too: 1.0e-07 rather than 1e-7.
 * @param {number} value
 */
function numeral(value) {
  const text = String(value);
  return text.includes('e') && !text.includes('.') ? text.replace('e', '.0e') : text;
}
