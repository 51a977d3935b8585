// live/net/socket.js (frames) and missed-rows.js: samples on their way into the ring.

import assert from 'node:assert/strict';
import {afterEach, test} from 'node:test';
import {Arrivals} from '../../frontend/live/net/missed-rows.js';
import {decode} from '../../frontend/live/net/socket.js';
import {Samples} from '../../frontend/live/state/samples.js';

// requests name the language of the page
Object.assign(globalThis, {document: {documentElement: {lang: 'en'}}});

const {fetch} = globalThis;
afterEach(() => {
  globalThis.fetch = fetch;
});

/** The header and samples of a frame, as shared/thetascope_schemas/service/session.py describes them. */
function encoded() {
  const buffer = new ArrayBuffer(24 + 6 * 4);
  const view = new DataView(buffer);
  view.setUint32(0, 7, true);
  view.setUint32(4, 3, true);
  view.setBigUint64(8, 5_000_000_000n, true);
  view.setUint32(16, 3, true);
  view.setUint32(20, 2, true);
  [1, 2, 3, 4, 5, 6].forEach((value, k) => view.setFloat32(24 + 4 * k, value, true));
  return buffer;
}

test('a frame has its header, and its samples column after column', () => {
  const {data, ...header} = decode(encoded());
  assert.deepEqual(header, {sequence: 7, epoch: 3, first: 5_000_000_000, count: 3, columns: 2});
  assert.deepEqual([...data], [1, 2, 3, 4, 5, 6]);
});

const RECORD = 0.01;

/** The value of a row that the server has. @param {number} row */
const truth = (row) => Math.fround(Math.sin(row / 40));

/**
 * A server with `rows` rows that answers with every n-th of them; `answers` counts its answers.
 * @param {number} rows
 */
function serve(rows) {
  const server = {answers: 0, refusals: 0};
  globalThis.fetch = async (address) => {
    const query = new URL(String(address), 'http://localhost').searchParams;
    if (server.refusals > 0) {
      server.refusals -= 1;
      return new Response('{}', {status: 503, headers: {'content-type': 'application/json'}});
    }
    server.answers += 1;
    const first = Math.round(Number(query.get('from')) / RECORD);
    const last = Math.min(rows - 1, Math.round(Number(query.get('to')) / RECORD));
    const every = Number(query.get('every'));
    const kept = Array.from({length: Math.floor((last - first) / every) + 1}, (_, k) => first + k * every);
    /** @param {number[]} values */
    const column = (values) => ({bdata: Buffer.from(Float64Array.from(values).buffer).toString('base64')});
    const columns = {t: column(kept.map((row) => row * RECORD)), a: column(kept.map(truth))};
    return Response.json({rows: kept.length, columns});
  };
  return server;
}

function arrivals() {
  const samples = new Samples(RECORD);
  samples.setColumns(['t', 'a']);
  samples.epoch = 1;
  return {samples, into: new Arrivals(samples, 's', () => {})};
}

/** @param {number} first @param {number} count @param {number} [epoch] */
function frame(first, count, epoch = 1) {
  const rows = Array.from({length: count}, (_, k) => first + k);
  const data = Float32Array.from([...rows.map((row) => row * RECORD), ...rows.map(truth)]);
  return {sequence: 0, epoch, first, count, columns: 2, data};
}

test('rows that were not sent are fetched in order, while later frames wait', async () => {
  const server = serve(2600);
  server.refusals = 1;
  const {samples, into} = arrivals();
  into.frame(frame(0, 100));
  const done = into.jump({type: 'jump', epoch: 1, first: 100, row: 900});
  into.frame(frame(900, 100));
  into.jump({type: 'jump', epoch: 1, first: 1000, row: 2500});
  into.frame(frame(2500, 100));
  assert.equal(samples.rows, 100, 'nothing overtakes what is fetched');
  await done;
  assert.deepEqual([samples.rows, server.answers], [2600, 2]);
  for (let row = 0; row < 2600; row += 1) assert.equal(samples.value('a', row), truth(row), `row ${row}`);
});

test('many missed rows are fetched thinned out, each held until the next', async () => {
  serve(100_000);
  const {samples, into} = arrivals();
  await into.jump({type: 'jump', epoch: 1, first: 0, row: 100_000});
  assert.equal(samples.rows, 100_000);
  for (const row of [0, 1, 24, 25, 50_000, 99_999]) assert.equal(samples.value('a', row), truth(row - (row % 25)));
});

test('frames of an epoch that is over are dropped', () => {
  const {samples, into} = arrivals();
  into.frame(frame(0, 10, 0));
  assert.equal(samples.rows, 0);
  into.frame(frame(0, 10));
  assert.equal(samples.rows, 10);
});
