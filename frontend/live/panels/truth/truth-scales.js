// The sliders of a truth: ranges from the sizes of states, parameters and times.

import {linear, logarithmic, nice} from '../../../widgets/slider-scale.js';

/** @import {Scale} from '../../../widgets/slider-scale.js' */
/** @import {Experiment, Plant} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */

/**
 * The size of a typical change of a state: as declared, else the range that it has had, else that of its domain, else
 * its own size.
 * @param {Plant['states'][number]} state
 * @param {{min: number, max: number}} range   of its values so far
 */
export function sizeOf({scale, domain: [low, high], initial}, {min, max}) {
  if (scale) return scale;
  const level = Math.max(...[min, max, initial].filter(Number.isFinite).map(Math.abs));
  if (max - min > 1e-3 * level) return max - min;
  if (low !== null && high !== null) return (high - low) / 10;
  return level / 10 || 1;
}

/**
 * Process noise: a random walk of the middle value moves by the size of the state within the horizon.
 * @param {number} size
 * @param {number} horizon   s
 * @returns {Scale}
 */
export function noiseScale(size, horizon) {
  const middle = nice(size / Math.sqrt(horizon));
  return logarithmic(middle / 100, 10 * middle, true);
}

/**
 * The true value of a parameter: half to one and a half of its value, within its bounds.
 * @param {number} value   in the model
 * @param {readonly [number | null, number | null]} bounds
 * @returns {Scale}
 */
export function parameterScale(value, [low, high]) {
  const reach = Math.abs(value) / 2 || Math.min(Math.abs(low ?? 1) || 1, Math.abs(high ?? 1) || 1);
  return linear(Math.max(low ?? -Infinity, value - reach), Math.min(high ?? Infinity, value + reach));
}

/**
 * The time between samples of an output where the truth gives none: that of the plant, of the measurement or of the
 * noise.
 * @param {Plant} plant
 * @param {Pick<Experiment, 'measurement'>} spec
 * @param {{sample_time: number} | undefined} noise
 * @returns {number | null}   s; null: it has none
 */
export function periodOf(plant, {measurement}, noise) {
  if (plant.time.kind === 'discrete') return plant.time.period;
  if ('period' in measurement) return measurement.period;
  return noise?.sample_time ?? null;
}

/**
 * Sample periods and correlation times: from the sensor's own one, else ten steps, to a tenth of the horizon.
 * @param {number} least     the shortest one, s
 * @param {number} horizon   s
 * @returns {Scale}
 */
export const timeScale = (least, horizon) => logarithmic(least, Math.max(horizon / 10, 10 * least), true);

/**
 * Delays of samples, which are shorter than the period.
 * @param {number | null} period   s
 * @param {number} step            s
 * @returns {Scale}
 */
export const jitterScale = (period, step) => linear(0, Math.max(step, (period ?? 10 * step) - step));

/**
 * The value of a parameter in the model: the experiment's, else the plant's.
 * @param {service.Plant['parameters'][number]} parameter
 * @param {Pick<Experiment, 'parameters'>} spec
 */
export const modelValue = ({name, value}, {parameters}) => parameters[name] ?? value;
