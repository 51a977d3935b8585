// Templates of messages → sentences, exactly as backend/thetascope/messages/catalogue.py renders them;
// tests/messages/rendering.json holds both to the same results. Pure.

const FIELD = /\{([\p{L}\p{N}_]+)(?::([^{}]*))?\}|\{\{|\}\}/gu;
const FORMAT = /^(\+?)(,?)(?:\.(\d+))?([gfe%]?)$/;
const BLANK = /(?<=[\u3000-\u303f\u4e00-\u9fff\uff00-\uffef]) +(?=[\u3000-\u303f\u4e00-\u9fff\uff00-\uffef])/g;
const GUARD = 25; // digits after which a decimal expansion of a double that was a tie so far is a tie

/**
 * @typedef {string | number | boolean | null | undefined | Message | Argument[]} Argument
 * @typedef {{code: string, args?: {[name: string]: Argument}, text?: string}} Message
 */

/**
 * The words of one language: code → template, or a template for each plural form; `plural` names these forms in their
 * order, by the categories of Unicode's CLDR.
 * @typedef {{language: string, plural: string[], messages: Record<string, string | string[]>}} Words
 */

/** Renders messages with the words of one language, as GET /api/messages/{language} gives them. */
export class Catalogue {
  /** @param {Words} words */
  constructor({language, plural, messages}) {
    this.language = language;
    this.templates = messages;
    this.forms = plural;
    this.plurals = new Intl.PluralRules(language);
  }

  /** Whether the catalogue has words for a code. @param {string} code */
  has(code) {
    return Object.hasOwn(this.templates, code);
  }

  /**
   * The sentence of a message. An unknown code is shown with its arguments, so that nothing is lost.
   * @param {Message} message
   * @returns {string}
   */
  render({code, args = {}}) {
    const template = this.template(code, args);
    if (template === undefined) {
      const shown = Object.entries(args).map(([name, value]) => `${name}=${this.value(value, '')}`);
      return shown.length ? `${code}(${shown.join(', ')})` : code;
    }
    const sentence = template.replace(FIELD, (whole, name, format) => {
      if (name === undefined) return whole[0];
      return Object.hasOwn(args, name) ? this.value(args[name], format ?? '') : whole;
    });
    return withoutBlanks(sentence);
  }

  /**
   * The template of a code, in the plural form that the argument `n` asks for.
   * @param {string} code
   * @param {Record<string, Argument>} args
   */
  template(code, args) {
    const entry = this.has(code) ? this.templates[code] : undefined;
    if (!Array.isArray(entry)) return entry;
    const n = args.n ?? 1;
    const whole = typeof n === 'number' && Number.isInteger(n);
    const place = this.forms.indexOf(this.plurals.select(whole ? Math.abs(n) : 2));
    return entry[Math.min(place, entry.length - 1)];
  }

  /** @param {Argument} value @param {string} format @returns {string} */
  value(value, format) {
    if (value === null || value === undefined) return '–';
    if (Array.isArray(value)) {
      const each = format === 'or' || format === 'and' ? '' : format;
      return this.joined(
        value.map((item) => this.value(item, each)),
        format,
      );
    }
    if (typeof value === 'object') return this.render(value);
    if (typeof value === 'number') return formatted(value, format);
    if (typeof value === 'boolean') return value ? 'True' : 'False';
    return value;
  }

  /** @param {string[]} items @param {string} how */
  joined(items, how) {
    const comma = /** @type {string} */ (this.templates['join.comma'] ?? ', ');
    const last = items.at(-1);
    if ((how !== 'or' && how !== 'and') || last === undefined || items.length < 2) return items.join(comma);
    const pair = /** @type {string} */ (this.templates[`join.${how}`] ?? '{head}, {last}');
    return pair.replace('{head}', () => items.slice(0, -1).join(comma)).replace('{last}', () => last);
  }
}

/** Words without the blanks that a template has around a name which turns out to be Chinese. @param {string} words */
export const withoutBlanks = (words) => words.replace(BLANK, '');

/**
 * A number as Python's format writes it: .Ng, .Nf, .N%, `,` for thousands, `+` for the sign.
 * @param {number} value
 * @param {string} format
 */
export function formatted(value, format) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? 'nan' : value > 0 ? 'inf' : '-inf';
  if (format === '') return Number.isInteger(value) ? String(value) : general(value, 6);
  const parts = FORMAT.exec(format);
  if (!parts) throw new RangeError(`no such format: ${format}`);
  const [, sign, thousands, places, kind] = parts;
  const plain = written(value, kind, Number(places ?? 6));
  const grouped = thousands
    ? String(plain).replace(/^(-?\d+)/, (whole) => whole.replace(/\B(?=(\d{3})+$)/g, ','))
    : plain;
  return sign && value >= 0 ? `+${grouped}` : grouped;
}

/** @param {number} value @param {string} kind @param {number} digits */
function written(value, kind, digits) {
  switch (kind) {
    case 'g':
      return general(value, digits);
    case 'f':
      return fixed(value, digits);
    case 'e':
      return powered(...scientific(value, digits));
    case '%':
      return `${fixed(100 * value, digits)}%`;
    default:
      return String(value);
  }
}

/**
 * Python's `g`: significant digits without trailing zeros, a power of ten where it is shorter.
 * @param {number} value
 * @param {number} digits
 */
function general(value, digits) {
  if (value === 0) return '0';
  const precision = Math.max(1, digits);
  const [mantissa, power] = scientific(value, precision - 1);
  if (power >= -4 && power < precision) return trimmed(fixed(value, precision - 1 - power));
  return powered(trimmed(mantissa), power);
}

/** Mantissa and power as Python writes them: 1.2e-05. @param {string} mantissa @param {number} power */
const powered = (mantissa, power) => `${mantissa}e${power < 0 ? '-' : '+'}${String(Math.abs(power)).padStart(2, '0')}`;

/** @param {string} number */
const trimmed = (number) => (number.includes('.') ? number.replace(/\.?0+$/, '') : number);

/**
 * Decimals, a tie to the even digit as in Python (toFixed takes the larger one).
 * @param {number} value
 * @param {number} places
 */
const fixed = (value, places) => even(value.toFixed(places), value.toFixed(Math.min(100, places + GUARD)), places);

/** Mantissa and power of ten, likewise. @param {number} value @param {number} places @returns {[string, number]} */
function scientific(value, places) {
  const [mantissa, power] = value.toExponential(places).split('e');
  const [exact, truePower] = value.toExponential(Math.min(100, places + GUARD)).split('e');
  const down = even(mantissa, exact, places);
  return down === mantissa ? [mantissa, Number(power)] : [down, Number(truePower)];
}

/** @param {string} rounded @param {string} exact  with more digits @param {number} places */
function even(rounded, exact, places) {
  const end = exact.indexOf('.') + 1 + places;
  if (!/^50*$/.test(exact.slice(end))) return rounded;
  const cut = exact.slice(0, places === 0 ? end - 1 : end);
  return '02468'.includes(/** @type {string} */ (cut.at(-1))) ? cut : rounded;
}
