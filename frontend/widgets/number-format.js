// Numbers as the scope shows them: of one width, with as many decimals as the axis can distinguish.

const RAISED = '⁰¹²³⁴⁵⁶⁷⁸⁹';

const LONGEST = 9; // characters

/**
 * A value with a number of decimals and a true minus, as a power of ten where that would be long; '–' if it is missing.
 * @param {number} value
 * @param {number} places
 */
export function fixed(value, places) {
  if (!Number.isFinite(value)) return '–';
  const text = value.toFixed(places);
  if (Math.abs(value) >= 1e6 || text.length > LONGEST) return power(value);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

/**
 * 3.2·10⁻⁷
 * @param {number} value
 */
export function power(value) {
  if (value === 0) return '0';
  const [mantissa, exponent] = value.toExponential(1).split('e');
  return `${mantissa}·10${raised(Number(exponent))}`.replace('-', '−');
}

/** @param {number} exponent */
export const raised = (exponent) =>
  (exponent < 0 ? '⁻' : '') + [...String(Math.abs(exponent))].map((digit) => RAISED[Number(digit)]).join('');

/**
 * A time in plain seconds for a clock or an axis whose marks are `step` apart: 78.4
 * @param {number} t
 * @param {number} [step]
 */
export function seconds(t, step = 0.1) {
  const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  if (places <= 4 || t === 0 || !Number.isFinite(t)) return t.toFixed(Math.min(4, places));
  const digits = Math.max(0, Math.min(8, Math.floor(Math.log10(Math.abs(t))) + places));
  const [mantissa, exponent] = t.toExponential(digits).split('e');
  return `${mantissa}·10${raised(Number(exponent))}`.replace('-', '−');
}

/** Speeds to choose from, by menu and by key; null: as fast as possible. */
export const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, null];

/**
 * 0.1×, 10×; ∞ for as fast as possible.
 * @param {number | null} speed
 */
export const times = (speed) => (speed === null ? '∞' : `${Number(speed.toPrecision(3))}×`);
