// diagnosis/findings.js: the server's verdicts as findings; live/state/reduce.js: the server's facts in the page's
// state.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {findings, stateOf} from '../../frontend/diagnosis/findings.js';
import {reduce} from '../../frontend/live/state/reduce.js';
import {initial} from '../../frontend/live/state/store.js';

/** @import * as service from '../../frontend/types/service.js' */
/** @typedef {service.AlarmOutcome['state']} AlarmState */

/** @param {string} id @param {number} t @param {Partial<service.Alarm>} [more] @returns {service.Alarm} */
const alarm = (id, t, more) => ({
  id,
  observer: '',
  t,
  kind: 'fault',
  channel: 'a',
  output: '',
  alternatives: [],
  onset: t,
  onset_from: t,
  onset_to: t,
  size: 1,
  size_from: 0.9,
  size_to: 1.1,
  test: 'glr',
  statistic: 40,
  threshold: 30,
  cleared: null,
  text: {code: '', args: {}, text: ''},
  ...more,
});

/**
 * @param {string} id
 * @param {AlarmState} state
 * @param {Partial<service.AlarmOutcome>} [more]
 * @returns {service.AlarmOutcome}
 */
const verdict = (id, state, more) => ({
  id,
  verdict: 'correct',
  state,
  found: [],
  delay: null,
  covers_since: null,
  ...more,
});

/** @param {Partial<service.Facts>} more @returns {service.Facts} */
const facts = (more) => ({
  t: 30,
  observers: [],
  faults: [],
  noise: {},
  truth: {deviation: 0, parameters: {}, process_noise: {}, outputs: {}, states: [], dynamics: {}, record: null},
  broken: null,
  judged: null,
  alarms: [],
  alarm_verdicts: [],
  fault_outcomes: [],
  undetected: [],
  summary: {code: 'diagnosis.summary.quiet', args: {}, text: ''},
  ...more,
});

/** @param {string} id @param {string} subject @returns {service.FaultNow} */
const fault = (id, subject) => ({
  id,
  subject,
  kind: 'channel',
  shape: 'step',
  fault: {channel: subject, shape: 'step', onset: 20, end: null, size: 1},
  onset: 20,
  end: null,
  active: true,
  ended: false,
});

test('every state of an alarm has a finding; active alarms first, then faults without one, cleared alarms last', () => {
  /** @type {AlarmState[]} */
  const states = ['cleared', 'acting', 'covering', 'other-fault', 'no-fault', 'fault-over', 'cleared'];
  const found = findings(
    stateOf(
      facts({
        faults: [fault('b@20.0', 'b')],
        alarms: states.map((state, k) => alarm(`d-${k}`, k, state === 'cleared' ? {cleared: k + 0.5} : {})),
        alarm_verdicts: states.map((state, k) => verdict(`d-${k}`, state, {delay: 0.6, covers_since: 25})),
        undetected: ['b@20.0'],
      }),
    ),
  );
  assert.deepEqual(
    found.map((one) => [one.alarm?.id ?? one.fault?.id, one.verdict, one.delay, one.again]),
    [
      ['d-1', 'found', 0.6, null],
      ['d-2', 'found', null, 25],
      ['d-3', 'misattributed', 0.6, null],
      ['d-4', 'false', 0.6, null],
      ['d-5', 'over', 0.6, null],
      ['b@20.0', 'undetected', null, null],
      ['d-6', 'past', 0.6, null],
      ['d-0', 'past', 0.6, null],
    ],
  );
});

test('alarms and verdicts are joined by id, never by time: two alarms raised at once keep their own', () => {
  const found = findings(
    stateOf(
      facts({
        alarms: [alarm('d-1', 5), alarm('d-2', 5, {kind: 'unexplained', channel: '', output: 'y.speed'})],
        alarm_verdicts: [verdict('d-2', 'no-fault'), verdict('d-1', 'acting')],
      }),
    ),
  );
  assert.deepEqual(
    found.map((one) => [one.subject, one.onChannel, one.verdict]),
    [
      ['a', true, 'found'],
      ['speed', false, 'false'],
    ],
  );
});

test('facts replace observers, faults, noise and alarms of the state; an observer keeps its colour', () => {
  /** @param {string} label @returns {service.ObserverNow} */
  const observer = (label) => ({
    label,
    kind: 'joint-ekf',
    gains: {},
    options: {},
    config: /** @type {service.ObserverConfig} */ (/** @type {unknown} */ ({label, kind: 'joint-ekf'})),
    since: 0,
    diverged: null,
  });
  /** @param {import('../../frontend/live/types.js').State} state @param {...string} labels */
  const after = (state, ...labels) =>
    reduce(state, {type: 'facts', row: 1, facts: facts({observers: labels.map(observer), broken: 4})});
  const first = after(initial, 'one', 'two');
  const second = after(first, 'two');
  const third = after(second, 'two', 'one', 'three');
  assert.deepEqual(
    third.observers.map(({label, place}) => [label, place]),
    [
      ['two', 1],
      ['one', 0],
      ['three', 2],
    ],
  );
  assert.equal(third.broken, 4);
  assert.equal(after(third, 'two', 'one', 'three').observers, third.observers, 'the same array where nothing changes');
});
