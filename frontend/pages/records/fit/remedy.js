// What would mend a misfit, for each suspect: the words of the button, and the mapping or settings that it sets. Pure.

import {timeUnitWith, unitWith} from './units.js';

/** @import * as service from '../../../types/service.js' */
/** @typedef {service.ColumnMapping} Mapping */
/** @typedef {'name' | 'role' | 'column' | 'column_unit' | 'unit' | 'units' | 'factor' | 'offset'} Field */
/** @typedef {Pick<service.MappedQuantity, Field>} Quantity */
/**
 * @typedef {object} Remedy
 * @property {string} code   of the button's words
 * @property {{[name: string]: string | number | {code: string}}} args
 * @property {Mapping} [mapping]   instead of the present one
 * @property {string[]} [parameters]   to be fitted
 */
/** @typedef {{mapping: Mapping, quantities: readonly Quantity[]}} Present */

const KELVIN = 273.15;
const WORDS = /[^\p{L}\p{M}\p{N}_]+/u;

/**
 * The remedy for a suspect, or null where the page has none.
 * @param {Pick<service.MisfitSuspect, 'kind' | 'name' | 'factor'>} suspect
 * @param {Present} present
 * @returns {Remedy | null}
 */
export function remedyFor({kind, name, factor}, present) {
  switch (kind) {
    case 'time':
      return factor === null ? null : otherTime(factor, present.mapping);
    case 'output':
    case 'input':
      return factor === null ? null : scaled(concerned(name, kind, present), factor, present);
    case 'offset':
      return factor === null ? null : shifted(concerned(name, 'output', present), factor, present);
    case 'fahrenheit':
      return fahrenheit(concerned(name, 'output', present), present);
    case 'swap-inputs':
    case 'swap-outputs':
      return swapped(name, present);
    default:
      return {code: 'page.records.remedy.fit', args: {name}, parameters: [name]};
  }
}

/** @param {string} name @param {string} role @param {Present} present */
const concerned = (name, role, {quantities}) =>
  quantities.filter((one) => one.column !== null && (name === '*' ? one.role === role : one.name === name));

/** @param {number} factor @param {Mapping} mapping @returns {Remedy | null} */
function otherTime(factor, mapping) {
  const {column, unit, period} = mapping.time ?? {column: null, unit: null, period: null};
  if (column === null) {
    if (period === null) return null;
    const longer = Number((period * factor).toPrecision(12));
    return {
      code: 'page.records.remedy.period',
      args: {period: longer},
      mapping: {...mapping, time: {column, unit: null, period: longer}},
    };
  }
  const other = timeUnitWith(unit ?? 's', factor);
  if (other === null) return null;
  return {
    code: 'page.records.remedy.time',
    args: {unit: {code: `page.records.time-unit.${other}`}},
    mapping: {...mapping, time: {column, unit: /** @type {service.TimeMapping['unit']} */ (other), period: null}},
  };
}

/**
 * @param {Mapping} mapping
 * @param {[string, Partial<service.QuantityMapping>][]} changes
 * @returns {Mapping}
 */
function changedTo(mapping, changes) {
  const quantities = {...mapping.quantities};
  for (const [name, change] of changes) {
    const {column} = quantities[name];
    quantities[name] = {column, unit: null, factor: null, offset: null, ...change};
  }
  return {...mapping, quantities};
}

/** @param {readonly Quantity[]} concerned @param {number} factor @param {Present} present @returns {Remedy | null} */
function scaled(concerned, factor, {mapping}) {
  if (concerned.length === 0) return null;
  const units = concerned.map((one) => unitWith(one.column_unit || one.unit, factor, one.units));
  const changes = concerned.map((one, place) => {
    const unit = units[place];
    return /** @type {[string, Partial<service.QuantityMapping>]} */ ([
      one.name,
      unit === null ? {factor: one.factor * factor, offset: one.offset * factor} : {unit},
    ]);
  });
  const name = concerned.map((one) => one.name).join(', ');
  const [unit] = units;
  const same = unit !== null && units.every((one) => one === unit);
  return {
    code: same ? 'page.records.remedy.unit' : 'page.records.remedy.factor',
    args: same ? {name, unit} : {name, factor},
    mapping: changedTo(mapping, changes),
  };
}

/** @param {readonly Quantity[]} concerned @param {number} addend @param {Present} present @returns {Remedy | null} */
function shifted(concerned, addend, {mapping}) {
  if (concerned.length === 0) return null;
  const unit = addend > 0 ? '°C' : 'K';
  const name = concerned.map((one) => one.name).join(', ');
  const known = Math.abs(Math.abs(addend) - KELVIN) < 0.01 && concerned.every((one) => one.units.includes(unit));
  return {
    code: known ? 'page.records.remedy.unit' : 'page.records.remedy.offset',
    args: known ? {name, unit} : {name, offset: addend},
    mapping: changedTo(
      mapping,
      concerned.map((one) => [one.name, known ? {unit} : {factor: one.factor, offset: one.offset + addend}]),
    ),
  };
}

/** @param {readonly Quantity[]} concerned @param {Present} present @returns {Remedy | null} */
function fahrenheit(concerned, {mapping}) {
  if (concerned.length === 0 || !concerned.every((one) => one.units.includes('°F'))) return null;
  return {
    code: 'page.records.remedy.unit',
    args: {name: concerned.map((one) => one.name).join(', '), unit: '°F'},
    mapping: changedTo(
      mapping,
      concerned.map((one) => [one.name, {unit: '°F'}]),
    ),
  };
}

/** @param {string} names @param {Present} present @returns {Remedy | null} */
function swapped(names, {mapping}) {
  const [first, second] = names.split(WORDS).filter(Boolean);
  const {[first]: one, [second]: other} = mapping.quantities;
  if (!one || !other) return null;
  return {
    code: 'page.records.remedy.swap',
    args: {first, second},
    mapping: {...mapping, quantities: {...mapping.quantities, [first]: other, [second]: one}},
  };
}
