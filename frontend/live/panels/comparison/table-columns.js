// The columns of the full comparison, and the same table as CSV. Pure.

import {csvCell} from '../../../common/csv.js';

/** @import * as service from '../../../types/service.js' */

/**
 * A column: a measure of one estimate.
 * @typedef {{key: string, group: 'rmse' | 'settle' | 'noise', estimate: string, name: string}} Column
 */

/**
 * The columns of a table: the error of every estimate, then settling of the faults that had a step, then noise of all
 * faults. `estimate` is the column of the true value, `name` that of the state or fault.
 * @param {service.WindowTable} table
 * @returns {Column[]}
 */
export function columnsOf({observers}) {
  const all = observers.flatMap(({estimates}) => estimates);
  const names = [...new Set(all.map(({name}) => name))];
  // an observer that estimates no fault must not put states behind faults
  const ordered = [...names.filter((name) => name.startsWith('x.')), ...names.filter((name) => !name.startsWith('x.'))];
  const faults = ordered.filter((name) => name.startsWith('theta.'));
  const stepped = faults.filter((fault) => all.some(({name, outcome}) => name === fault && outcome !== 'unknown'));
  /** @param {Column['group']} group @param {string} estimate @returns {Column} */
  const column = (group, estimate) => ({
    key: `${group}:${estimate}`,
    group,
    estimate,
    name: estimate.slice(estimate.indexOf('.') + 1),
  });
  return [
    ...ordered.map((name) => column('rmse', name)),
    ...stepped.map((name) => column('settle', name)),
    ...faults.map((name) => column('noise', name)),
  ];
}

/**
 * A table as CSV: a line for each estimate of each observer, in full precision.
 * @param {service.WindowTable} table
 */
export function csvOf({observers}) {
  const lines = observers.flatMap(({label, estimates}) =>
    estimates.map(({name, rmse, noise, settled, outcome}) => [label, name, rmse, noise, settled, outcome]),
  );
  return [['observer', 'estimate', 'rmse', 'noise', 'settled_s', 'outcome'], ...lines]
    .map((line) => `${line.map(csvCell).join(',')}\r\n`)
    .join('');
}
