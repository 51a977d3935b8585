// The findings as a table of comma-separated values, one line for each explanation of each fault. Pure.

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
  return [HEAD, ...lines].map((line) => `${line.map(cell).join(',')}\n`).join('');
}

/**
 * A value as a cell. Text that a spreadsheet would take for a formula follows an apostrophe, and control characters are
 * blanks, as in files of the service (backend/thetascope/export/csv_format.py).
 * @param {string | number | boolean | null} value
 */
function cell(value) {
  if (typeof value !== 'string') return value === null ? '' : String(value);
  const line = value.replaceAll(/[\u0000-\u001f\u007f-\u009f\u2028\u2029]/gu, ' ');
  const text = /^\s*[=+\-@＝＋－＠]/u.test(line) ? `'${line}` : line;
  return /[",']/u.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
