// The findings as a table of comma-separated values, one line for each explanation of each fault. Pure.

import {csvCell} from '../../../common/csv.js';

/** @import * as service from '../../../types/service.js' */

const HEAD = [
  ...['fault', 'explanation', 'channel', 'shape', 'onset_s', 'onset_low_s', 'onset_high_s'],
  ...[
    'size',
    'size_low',
    'size_high',
    'unit',
    'rate_per_s',
    'bound',
    'alarm_s',
    'ended_s',
    'separable',
    'confirmed',
    'covered',
  ],
];

/**
 * @param {readonly service.RecordFault[]} faults
 * @returns {string}
 */
export function findingsCsv(faults) {
  const lines = faults.flatMap(({id, best, alternatives, alarm, ended, confirmed, covered}) =>
    [best, ...alternatives].map((one, place) => [
      ...[id, place === 0 ? 'best' : 'alternative', one.channel, one.shape],
      ...[one.onset.value, one.onset.low, one.onset.high, one.size.value, one.size.low, one.size.high],
      ...[one.unit, one.rate, one.bound, alarm, ended, one.separable, confirmed, covered],
    ]),
  );
  return [HEAD, ...lines].map((line) => `${line.map(csvCell).join(',')}\n`).join('');
}
