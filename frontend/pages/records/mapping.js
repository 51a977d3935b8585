// Changes of a mapping: which column is read as which quantity, in which unit. Pure.

/** @import * as service from '../../types/service.js' */
/** @typedef {service.ColumnMapping} Mapping */
/** @typedef {{[name: string]: Partial<service.QuantityMapping>}} Quantities */
/** @typedef {{time?: Partial<service.TimeMapping>, quantities?: Quantities}} Proposal */

const NONE = {column: null, unit: null, factor: null, offset: null};

/**
 * The mapping in which a column is read as `target`: 'time', the name of a quantity, or '' for none. What was read
 * from it before has no column any more.
 * @param {Mapping} mapping  complete
 * @param {string} column
 * @param {string} target
 * @param {number} period  s from row to row, if the times lose their column
 * @returns {Mapping}
 */
export function assigned(mapping, column, target, period) {
  const quantities = Object.fromEntries(
    Object.entries(mapping.quantities).map(([name, one]) => [name, one.column === column ? NONE : one]),
  );
  let time = mapping.time;
  if (target === 'time') time = {column, unit: null, period: null};
  else if (time?.column === column) time = {column: null, unit: null, period};
  if (target !== '' && target !== 'time') quantities[target] = {...NONE, column};
  return {time, quantities};
}

/**
 * The mapping in which a quantity's cells have another unit.
 * @param {Mapping} mapping
 * @param {string} name
 * @param {string} unit
 * @returns {Mapping}
 */
export function withUnit(mapping, name, unit) {
  const {column} = mapping.quantities[name];
  return {...mapping, quantities: {...mapping.quantities, [name]: {...NONE, column, unit}}};
}

/**
 * The mapping with other times.
 * @param {Mapping} mapping
 * @param {Partial<service.TimeMapping>} changes
 * @returns {Mapping}
 */
export const withTime = (mapping, changes) => ({
  ...mapping,
  time: {column: null, unit: null, period: null, ...mapping.time, ...changes},
});

/**
 * The mapping with a part of it replaced, as the inspection proposes.
 * @param {Mapping} mapping
 * @param {Proposal} proposal
 * @returns {Mapping}
 */
export function withProposal(mapping, {time, quantities = {}}) {
  const changed = Object.entries(quantities).map(([name, one]) => [
    name,
    {...NONE, column: mapping.quantities[name]?.column ?? null, ...one},
  ]);
  const next = {...mapping, quantities: {...mapping.quantities, ...Object.fromEntries(changed)}};
  return time ? withTime(next, time) : next;
}

/**
 * Whether a value from the wire is a part of a mapping.
 * @param {unknown} value
 * @returns {value is Proposal}
 */
export const isProposal = (value) =>
  value !== null && typeof value === 'object' && ('time' in value || 'quantities' in value);
