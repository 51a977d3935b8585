// The runs of the experiments that a page of a paper shows. Each is asked for once, one after another: the service
// computes them, or has them stored.

import {post, run} from '../../../common/api.js';

/** @import * as service from '../../../types/service.js' */

/** @type {Map<string, Promise<service.Run>>} */
const runs = new Map();
/** @type {Promise<unknown>} */
let queue = Promise.resolve();

/**
 * The run of an experiment of the library.
 * @param {string} experiment
 * @returns {Promise<service.Run>}
 */
export function resultOf(experiment) {
  let result = runs.get(experiment);
  if (!result) {
    const start = () => run({experiment}, () => {});
    result = queue.then(start, start);
    queue = result;
    runs.set(experiment, result);
    result.catch(() => runs.delete(experiment)); // asked for again where it is needed again
  }
  return result;
}

/**
 * The measured values of numbers, in their order; null where nothing was measured.
 * @param {readonly service.PaperNumber[]} numbers   of one experiment
 * @returns {Promise<(number | null)[]>}
 */
export async function measuredIn(numbers) {
  const {links} = await resultOf(numbers[0].experiment);
  const measures = Object.fromEntries(numbers.map(({measure}, place) => [`n${place}`, measure]));
  /** @type {service.Measured} */
  const {values} = await post(`${links.self}/measures`, {measures});
  return numbers.map((_, place) => values[`n${place}`]);
}
