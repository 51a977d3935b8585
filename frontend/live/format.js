// Numbers as the scope shows them: of one width, with as many decimals as the axis can tell apart.

const RAISED = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** Decimals that tell about a hundredth of the span apart. */
export function decimals(span) {
  if (!(span > 0)) return 3;
  return Math.max(0, Math.min(8, Math.ceil(-Math.log10(span) + 2.05)));
}

/** A value with so many decimals and a true minus; very large and small ones as powers of ten; '–' for none. */
export function fixed(value, places) {
  if (!Number.isFinite(value)) return '–';
  if (value !== 0 && (Math.abs(value) >= 1e6 || (places >= 8 && Math.abs(value) < 1e-5))) return power(value);
  const text = value.toFixed(places);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

/** 3.2·10⁻⁷ */
export function power(value) {
  const [mantissa, exponent] = value.toExponential(1).split('e');
  return `${mantissa}·10${raised(Number(exponent))}`.replace('-', '−');
}

export const raised = (exponent) => (exponent < 0 ? '⁻' : '') + [...String(Math.abs(exponent))].map((digit) => RAISED[digit]).join('');

/** A time for a clock or an axis whose marks are `step` apart: 78.4, 1:02:05 never; plain seconds are what the papers use. */
export function seconds(t, step = 0.1) {
  const places = Math.max(0, Math.min(4, Math.ceil(-Math.log10(step) - 1e-9)));
  return t.toFixed(places);
}

/** Speeds to choose from, by menu and by key; null: as fast as possible. */
export const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, null];

/** 0.1×, 10×; ∞ for as fast as possible. */
export const times = (speed) => (speed === null ? '∞' : `${Number(speed.toPrecision(3))}×`);
