// live/state/past.js: when the page looks back; diagnosis/findings.js: a fault that is not judged yet.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {findings, stateOf} from '../../frontend/diagnosis/findings.js';
import {momentOf} from '../../frontend/live/state/past.js';

/** @import * as service from '../../frontend/types/service.js' */

/** @type {{looking: number | null, selection: [number, number] | null, record: number}} */
const still = {looking: null, selection: null, record: 0.1};

test('the moment is the time on the timeline, else the end of a zoom in the past, else the present', () => {
  assert.equal(momentOf(still, 50), null);
  assert.equal(momentOf({...still, looking: 20, selection: [0, 30]}, 50), 20);
  assert.equal(momentOf({...still, selection: [10, 30]}, 50), 30);
  assert.equal(momentOf({...still, selection: [20, 50]}, 50), null);
  assert.equal(momentOf({...still, looking: 49.95}, 50), null);
});

test('a fault after the time up to which the detector has judged is not judged, rather than not found', () => {
  const fault = {subject: 'a', kind: 'channel', active: true, ended: false, end: null};
  const facts = /** @type {service.Facts} */ (
    /** @type {unknown} */ ({
      faults: [
        {...fault, id: 'a@10', onset: 10},
        {...fault, id: 'b@30', onset: 30},
      ],
      alarms: [],
      alarm_verdicts: [],
      undetected: ['a@10', 'b@30'],
      judged: 20,
    })
  );
  const verdicts = (/** @type {service.Facts} */ one) => findings({...stateOf(one), facts: one}).map((f) => f.unjudged);
  assert.deepEqual(verdicts(facts), [false, true]);
  assert.deepEqual(verdicts({...facts, judged: null}), [false, false]);
});
