// The values of what varies, as one writes them: `0.5 … 16, 8, log` is a range, `0.1 0.2 0.5` a list.

/** @import * as service from '../../types/service.js' */

/** @typedef {service.ListFactor | service.RangeFactor} Written   a factor that is written as a text */

const RANGE = /^(\S+?)\s*(?:…|\.\.\.?)\s*([^\s,]+)\s*(?:,\s*(\d+))?\s*(?:,\s*(log|linear))?$/;

/**
 * The factor that a text means; `null` for an empty one.
 * @param {string} path
 * @param {string} text
 * @param {boolean} grid   whether a range needs a number of values
 * @returns {Written | null}
 */
export function factorOf(path, text, grid) {
  const range = RANGE.exec(text.trim());
  if (range && isNumber(range[1]) && isNumber(range[2])) {
    return {
      kind: 'range',
      name: '',
      path,
      low: Number(range[1]),
      high: Number(range[2]),
      scale: range[4] === 'log' ? 'log' : 'linear',
      points: grid ? Number(range[3] ?? 5) : null,
    };
  }
  const items = text.split(/[\s,;]+/).filter(Boolean);
  return items.length ? {kind: 'list', name: '', path, values: items.map(valueOf)} : null;
}

/** @param {string} text */
const isNumber = (text) => text !== '' && Number.isFinite(Number(text));

/** @param {string} text */
const valueOf = (text) => (isNumber(text) ? Number(text) : text === 'true' ? true : text === 'false' ? false : text);

/**
 * The text of a factor.
 * @param {Written} factor
 */
export function textOf(factor) {
  if (factor.kind === 'list') return factor.values.map((value) => shown(value)).join(' ');
  const count = factor.points ? `, ${factor.points}` : '';
  return `${factor.low} … ${factor.high}${count}${factor.scale === 'log' ? ', log' : ''}`;
}

/** @param {unknown} value */
const shown = (value) => (typeof value === 'string' ? value : JSON.stringify(value));

/**
 * The paths of an experiment's numbers that a study may vary, the most usual first.
 * @param {service.Experiment} spec
 * @param {readonly service.ObserverKind[]} kinds
 * @param {readonly string[]} parameters   of the plant
 * @returns {string[]}
 */
export function pathsOf(spec, kinds, parameters) {
  const gains = spec.observers.flatMap((one) => {
    const known = kinds.find((kind) => kind.id === one.kind)?.gains.map((gain) => gain.name) ?? [];
    const given = Object.entries(one.gains ?? {}).flatMap(([name, value]) => (typeof value === 'number' ? [name] : []));
    return [...new Set([...given, ...known])].map((name) => `observers.${one.label}.gains.${name}`);
  });
  const noise = Object.keys(spec.noise).map((name) => `noise.${name}.std`);
  const faults = spec.faults.flatMap((fault, place) =>
    ['size', 'onset'].filter((field) => field in fault).map((field) => `faults.${place}.${field}`),
  );
  const values = parameters.map((name) => `parameters.${name}`);
  return [...gains, ...noise, ...faults, 'diagnosis.false_alarms', ...values, 'horizon'];
}
