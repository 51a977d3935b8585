// How units of the same quantity relate to each other, as far as the page must know it: to name the unit that would
// make a record fit. Pure; the server converts with all of its units.

const MINUTE = 60;
const HOUR = 3600;
const LITRE = 1e-3;

/** @type {{[unit: string]: number}[]} units of one kind, in the first one's multiples */
const FAMILIES = [
  {m: 1, km: 1e3, dm: 0.1, cm: 0.01, mm: 1e-3, µm: 1e-6, in: 0.0254, ft: 0.3048},
  {
    'm³/s': 1,
    'cm³/s': 1e-6,
    'L/s': LITRE,
    'L/min': LITRE / MINUTE,
    'L/h': LITRE / HOUR,
    'm³/h': 1 / HOUR,
    'mL/min': 1e-6 / MINUTE,
    gpm: 6.30901964e-5,
  },
  {Pa: 1, hPa: 100, kPa: 1e3, MPa: 1e6, mbar: 100, bar: 1e5, atm: 101325, psi: 6894.757293},
  {rad: 1, mrad: 1e-3, '°': Math.PI / 180, deg: Math.PI / 180},
  {'rad/s': 1, rpm: Math.PI / 30, '1/min': Math.PI / 30, '°/s': Math.PI / 180, 'deg/s': Math.PI / 180},
  {'m/s': 1, 'cm/s': 0.01, 'mm/s': 1e-3, 'km/h': 1 / 3.6},
  {'kg/s': 1, 'g/s': 1e-3, 'kg/h': 1 / HOUR, 'kg/min': 1 / MINUTE},
  {V: 1, mV: 1e-3, kV: 1e3},
  {A: 1, mA: 1e-3, µA: 1e-6, kA: 1e3},
  {W: 1, mW: 1e-3, kW: 1e3, MW: 1e6},
  {N: 1, kN: 1e3, mN: 1e-3},
  {kg: 1, g: 1e-3, mg: 1e-6, t: 1e3},
  {1: 1, '': 1, '%': 0.01, '‰': 1e-3},
];

/** @type {{[unit: string]: number}} units of time that are numbers, in s */
export const TIMES = {
  s: 1,
  ms: 1e-3,
  us: 1e-6,
  ns: 1e-9,
  min: MINUTE,
  h: HOUR,
  d: 24 * HOUR,
  'epoch-s': 1,
  'epoch-ms': 1e-3,
  'epoch-us': 1e-6,
  'epoch-ns': 1e-9,
};

/** @param {number} a @param {number} b */
const close = (a, b) => Math.abs(a / b - 1) < 1e-3;

/**
 * The unit among `units` in which a number stands for `ratio` times as much as in `unit`, or null.
 * @param {string} unit
 * @param {number} ratio
 * @param {readonly string[]} units
 */
export function unitWith(unit, ratio, units) {
  const family = FAMILIES.find((one) => Object.hasOwn(one, unit));
  if (!family) return null;
  return units.find((other) => Object.hasOwn(family, other) && close(family[other] / family[unit], ratio)) ?? null;
}

/**
 * The unit of time in which a number stands for `ratio` times as much as in `unit`, or null.
 * @param {string} unit
 * @param {number} ratio
 */
export function timeUnitWith(unit, ratio) {
  const group = unit.startsWith('epoch-');
  const others = Object.keys(TIMES).filter((other) => other.startsWith('epoch-') === group);
  return others.find((other) => close(TIMES[other] / (TIMES[unit] ?? NaN), ratio)) ?? null;
}
