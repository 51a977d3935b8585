// live/state/permalink.js and pages/runs/address.js: what an address holds comes back.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {deflateRawSync} from 'node:zlib';
import {changed, pack, read, specOf, unpack, write} from '../../frontend/live/state/permalink.js';
import * as address from '../../frontend/pages/runs/address.js';

/** @import {Experiment} from '../../frontend/live/types.js' */

const base = /** @type {Experiment} */ (
  /** @type {unknown} */ ({id: 'zhao-2012', title: 'T', figures: [1], faults: [], seed: 1, noise: {y: {std: 0.1}}})
);

/** @param {string} text */
const from = (text) => read(new URL(text, 'http://localhost/'));

test('an unchanged library experiment is written by its name, and its time where it has begun', async () => {
  assert.equal(await write({spec: base, t: 0, experiment: 'zhao-2012', base}), '?experiment=zhao-2012');
  assert.equal(await write({spec: base, t: 42.5, experiment: 'zhao-2012', base}), '?experiment=zhao-2012&t=42.5');
  const asked = await from('/?experiment=zhao-2012&t=42.5');
  assert.deepEqual(asked, {session: null, experiment: 'zhao-2012', t: 42.5});
});

test('prose and the order of keys are no change; every other field is', () => {
  assert.deepEqual(changed({...base, title: 'T', figures: []}, base), {});
  const reordered = /** @type {Experiment} */ (Object.fromEntries(Object.entries(base).reverse()));
  assert.deepEqual(changed(reordered, base), {});
  assert.deepEqual(changed({...base, seed: 2}, base), {seed: 2});
});

test('a changed experiment comes back with its changes', async () => {
  const spec = {...base, seed: 7, noise: {y: {std: 0.25, sample_time: 0.01}}};
  const asked = await from(`/${await write({spec, t: 3, experiment: 'zhao-2012', base})}`);
  assert.deepEqual([asked.experiment, asked.t], ['zhao-2012', 3]);
  assert.deepEqual(await specOf(asked, async () => base), spec);
});

test('an experiment of one’s own comes back whole', async () => {
  const asked = await from(`/${await write({spec: base, t: 1, experiment: null, base: null})}`);
  assert.deepEqual(await specOf(asked, () => Promise.reject(new Error('nothing is loaded'))), base);
});

test('a packed value is safe in an address and comes back, whatever it holds', async () => {
  for (const value of [{}, {text: 'θ̂₁ → “ü” 中文'}, Array.from({length: 500}, (_, k) => k / 7), null, '+/=']) {
    const text = await pack(value);
    assert.match(text, /^[\w-]*$/);
    assert.deepEqual(await unpack(text), value);
  }
});

test('a damaged fragment, or one that holds no experiment, is refused', async () => {
  const nonsense = await pack([1, 2]);
  for (const text of ['AAAA', `${nonsense.slice(0, -4)}zzzz`, nonsense, await pack({t: 3}), await pack({changed: {}})])
    await assert.rejects(from(`/#s=${text}`), Error, text);
});

test('a fragment that unpacks to gigabytes is refused before it does', async () => {
  const bomb = deflateRawSync(Buffer.alloc(64 * 1024 * 1024, 32)).toString('base64url');
  assert.ok(bomb.length < 100_000);
  await assert.rejects(unpack(bomb), /too much/u);
});

test('a negative or unreadable time is no time', async () => {
  for (const t of ['-1', 'x', 'Infinity', '']) assert.equal((await from(`/?experiment=a&t=${t}`)).t, 0);
});

test('the choice of a run comes back from its address', () => {
  for (const chosen of [
    {experiment: 'zhao-2012', changes: {seed: 3, 'noise.y.std': 0, horizon: 1e-3}, run: 'abc'},
    {experiment: 'a b&c', changes: {title: 'x = y', list: [1, 2], flag: true, none: null}, run: null},
    {experiment: null, changes: {}, run: null},
  ])
    assert.deepEqual(address.read(new URL(address.write(chosen), 'http://localhost').search), chosen);
});

test('a typed value is a number or JSON where it reads as one, else text', () => {
  assert.deepEqual(['1e-3', ' -.5 ', '007', '[1, 2]', 'true', '"3"', 'three', ''].map(address.value), [
    0.001,
    -0.5,
    7,
    [1, 2],
    true,
    '3',
    'three',
    '',
  ]);
});
