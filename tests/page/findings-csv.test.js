// pages/records/findings/findings-csv.js: the file of findings is read back by spreadsheets as text and numbers.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {findingsCsv} from '../../frontend/pages/records/findings/findings-csv.js';

/** @import * as service from '../../frontend/types/service.js' */

/** @param {string} unit */
const fault = (unit) =>
  /** @type {service.RecordFault} */ (
    /** @type {unknown} */ ({
      ...{id: 'F1', alarm: 41.5, ended: null, confirmed: true, covered: false, alternatives: []},
      best: {
        ...{channel: 'leak', shape: 'step', unit, rate: null, bound: null, separable: true},
        ...{onset: {value: 40, low: 39, high: 41}, size: {value: -2, low: -3, high: -1}},
      },
    })
  );

test('a unit is text, however it begins: no spreadsheet takes it for a formula', () => {
  for (const unit of ['=1+1', '+1', '-1', '@SUM(A1)', '＝1', ' =1', '\t=1', '\r=1', '=HYPERLINK("http://x")']) {
    const [, line, end] = findingsCsv([fault(unit)]).split('\n');
    assert.match(line, /,-2,-3,-1,"'[ ]?[=+@＝-][^\r\t]*",,,41\.5,,true,true,false$/u);
    assert.equal(end, '');
  }
});

test('numbers and plain units are as they are, and quotes are doubled', () => {
  assert.ok(findingsCsv([fault('cm³/s')]).endsWith(',40,39,41,-2,-3,-1,cm³/s,,,41.5,,true,true,false\n'));
  assert.ok(findingsCsv([fault('a"b,c')]).includes(',"a""b,c",'));
});
