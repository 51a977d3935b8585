// live/scope/mark-words.js: the meaning of the mark under the pointer.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {markWords} from '../../frontend/live/scope/mark-words.js';

/** @import {App, DrawnStrip, Row} from '../../frontend/live/types.js' */

const alarm = {explained: true, subject: 'a', subjects: ['a', 'b'], t: 50, over: 70, onset: 30, from: 28, to: 32};
const app = /** @type {App} */ (/** @type {unknown} */ ({state: {alarms: [alarm], record: 0.01}, samples: {now: 90}}));

/** One pixel is a second; the plot is 100 px high. @param {string} subject @param {number} x @param {number} y */
function at(subject, x, y) {
  const strip = /** @type {DrawnStrip} */ (
    /** @type {unknown} */ ({kind: 'theta', subject, leaving: [{from: 10, to: 12, up: true}]})
  );
  const row = /** @type {Row} */ (/** @type {unknown} */ ({strip, place: {height: 100}}));
  return markWords(row, x, y, (px) => px, app);
}

test('a flag, its bar, the onset and a curve that leaves the axis have words where they are drawn', () => {
  const found = [at('a', 50, 5), at('b', 50, 5), at('a', 60, 2), at('a', 30, 97), at('a', 11, 3)];
  assert.equal(new Set(found).size, 5, found.join('\n'));
  assert.ok(found.every((words) => words !== ''));
});

test('elsewhere, and on a strip that the alarm does not name, there is nothing to say', () => {
  for (const [subject, x, y] of /** @type {[string, number, number][]} */ ([
    ['a', 50, 50],
    ['a', 80, 2],
    ['c', 50, 5],
    ['c', 30, 97],
  ]))
    assert.equal(at(subject, x, y), '');
});
