// The form of a fault, from the catalogue's description of its shape: fields, first values, sliders.

import {linear, logarithmic, nice} from '../../../widgets/slider-scale.js';

/** @import {Scale} from '../../../widgets/slider-scale.js' */
/** @import * as service from '../../../types/service.js' */

/** @typedef {string | number | number[] | null} FieldValue */
/**
 * The part of a field that reading needs.
 * @typedef {Pick<service.FormField, 'type' | 'nullable' | 'description'> & Partial<service.FormField>} TypedField
 */
/** @typedef {{[field: string]: FieldValue}} Values */

/**
 * The channel or output that a fault acts on.
 * @typedef {object} Subject
 * @property {string} name
 * @property {boolean} onChannel
 * @property {number} typical      a usual size: the channel's, or a share of the output's own size
 * @property {[number|null, number|null]} bounds
 * @property {string} unit
 * @property {number} level        the output's present value
 * @property {number} horizon      s
 * @property {number} sampleTime   s
 */

/**
 * @param {unknown} value
 * @returns {value is number}
 */
const isNumber = (value) => typeof value === 'number';

const GENERAL = new Set(['onset', 'end', 'channel', 'output']);

/**
 * The fields that are a shape's own.
 * @param {service.FaultForm} shape
 */
export const ownFields = (shape) => shape.fields.filter((field) => !GENERAL.has(field.name));

/**
 * The one that a slider sets: the first number.
 * @param {service.FaultForm} shape
 */
export const mainField = (shape) => ownFields(shape).find((field) => field.type === 'number') ?? null;

/** First values by the name of a field; other fields have their default, or the value of the catalogue's example. */
/** @type {{[field: string]: (subject: Subject) => FieldValue}} */
const FIRST = {
  size: (subject) => (subject.onChannel ? subject.typical : nice(subject.typical)),
  rate: (subject) => nice(subject.typical / (subject.horizon / 10)),
  intensity: (subject) => nice(subject.typical / Math.sqrt(subject.horizon / 5)),
  value: (subject) => Number(subject.level.toPrecision(3)),
  std: (subject) => nice(subject.typical / 4),
  resolution: (subject) => nice(subject.typical / 3),
  probability: () => 0.3,
  duration: (subject) => nice(subject.horizon / 20),
  time_constant: (subject) => nice(subject.horizon / 30),
  period: (subject) => nice(subject.horizon / 20),
  width: (subject) => nice(subject.horizon / 20) / 2,
  frequency: (subject) => nice(10 / subject.horizon),
  delay: (subject) => Math.max(subject.sampleTime, nice(subject.horizon / 200)),
  sample_time: (subject) => subject.sampleTime,
  values: (subject) => [0, subject.typical],
  times: (subject) => [0, nice(subject.horizon / 20)],
};

/**
 * First values of a shape's own fields.
 * @param {service.FaultForm} shape
 * @param {Subject} subject
 * @returns {Values}
 */
export function firstValues(shape, subject) {
  return Object.fromEntries(
    ownFields(shape).map((field) => [
      field.name,
      FIRST[field.name]?.(subject) ?? /** @type {FieldValue} */ (field.default ?? shape.example[field.name] ?? null),
    ]),
  );
}

/**
 * The slider of the main field.
 * @param {service.FormField} field
 * @param {Subject} subject
 * @param {number} first
 * @returns {Scale}
 */
export function mainScale(field, subject, first) {
  if (isNumber(field.maximum) && isNumber(field.minimum)) return linear(field.minimum, field.maximum);
  if (field.name === 'value') return linear(subject.level - 3 * subject.typical, subject.level + 3 * subject.typical);
  const reach = 3 * (Math.abs(first) || subject.typical || 1);
  const positive = field.minimum === 0 || field.above === 0;
  if (field.name === 'size' || field.name === 'rate') {
    const [low, high] = subject.onChannel && field.name === 'size' ? subject.bounds : [null, null];
    return linear(Math.max(low ?? -Infinity, -reach), Math.min(high ?? Infinity, reach));
  }
  return positive ? logarithmic(Math.abs(first) / 20 || 0.001, 10 * Math.abs(first) || 1) : linear(-reach, reach);
}

/**
 * Smallest and largest value that may be typed.
 * @param {service.FormField} field
 * @param {Subject} subject
 */
export function limits(field, subject) {
  const [low, high] = subject.onChannel && field.name === 'size' ? subject.bounds : [null, null];
  const least = field.minimum ?? (isNumber(field.above) ? field.above + Number.MIN_VALUE : null);
  return {low: least ?? low ?? -Infinity, high: field.maximum ?? high ?? Infinity};
}

/**
 * A typed text as a value of a field; undefined if it is not valid.
 * @param {TypedField} field
 * @param {string} text
 * @returns {FieldValue | undefined}
 */
export function read(field, text) {
  const trimmed = text.trim().replace('−', '-');
  if (field.type === 'array') {
    const parts = trimmed
      .split(/[\s,;]+/)
      .filter(Boolean)
      .map(Number);
    return parts.length && parts.every(Number.isFinite) ? parts : undefined;
  }
  if (field.type === 'choice') return trimmed;
  if (trimmed === '') return field.nullable ? null : undefined;
  const value = Number(trimmed.replace(',', '.'));
  const fits =
    Number.isFinite(value) &&
    value >= (field.minimum ?? -Infinity) &&
    value > (field.above ?? -Infinity) &&
    value <= (field.maximum ?? Infinity);
  return fits ? value : undefined;
}

/**
 * A value as one types it.
 * @param {unknown} value
 */
export const asTyped = (value) =>
  Array.isArray(value) ? value.join(', ') : value === null || value === undefined ? '' : String(value);
