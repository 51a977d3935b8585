// Frames on their way into the samples, in order. Rows that were not sent because this page was too far behind are
// fetched thinned out, so that the curves have no hole; frames that come meanwhile wait.

import {get} from '../../common/api.js';

/** @import {Frame, Jump, Samples} from '../types.js' */

/** @typedef {{rows: number, columns: {[name: string]: {bdata: string}}}} Table   float64 in base64 */

const MOST = 4000; // rows per request
const PIECE = 8192; // rows per push
const TRIES = [0, 400, 1500, 4000]; // ms before each; then there is a hole, which is what there is

export class Arrivals {
  /**
   * Where the frames of a session go; `done` is called whenever something new is there.
   * @param {Samples} samples
   * @param {string} session
   * @param {() => void} done
   */
  constructor(samples, session, done) {
    this.samples = samples;
    this.session = session;
    this.done = done;
    /** @type {({frame: Frame} | {jump: Jump})[]} */
    this.waiting = [];
  }

  /**
   * A frame that came. Frames of an epoch that is over are void: what replaces them is on its way.
   * @param {Frame} frame
   */
  frame(frame) {
    if (this.samples.held) this.waiting.push({frame});
    else this.put(frame);
    this.done();
  }

  /** @param {Frame} frame */
  put(frame) {
    const {samples} = this;
    if (frame.epoch === samples.epoch && frame.columns === samples.sent.length)
      samples.push(frame.first, frame.count, frame.data);
  }

  /**
   * Rows first … row − 1 will not be sent: {first, row}.
   * @param {Jump} jump
   */
  async jump(jump) {
    this.waiting.push({jump});
    if (this.samples.held) return;
    this.samples.held = true;
    for (let next = this.waiting.shift(); next; next = this.waiting.shift()) {
      if ('frame' in next) this.put(next.frame);
      else await this.fetch(next.jump);
    }
    this.samples.held = false;
    this.done();
  }

  /** @param {Jump} jump */
  async fetch({first, row}) {
    const {samples, session} = this;
    for (const pause of TRIES) {
      await new Promise((go) => {
        setTimeout(go, pause);
      });
      const names = samples.sent;
      try {
        await fetchMissed({
          session,
          names,
          record: samples.record,
          first,
          last: row,
          push: (...rows) => {
            if (samples.sent === names) samples.push(...rows);
          },
        });
        if (samples.sent === names) return; // else an observer was added or removed, and its columns are requested, too
      } catch {
        /* the server is busy or the session over: once more */
      }
    }
  }
}

/**
 * Fetch rows first … last − 1 of a session and give them to `push(first, count, data)` as if they had been sent, each
 * held until the next.
 * @param {{session: string, names: string[], record: number, first: number, last: number,
 *   push: (first: number, count: number, data: Float32Array) => void}} options
 * @returns {Promise<void>}
 */
async function fetchMissed({session, names, record, first, last, push}) {
  const every = Math.max(1, Math.ceil((last - first) / MOST));
  const query = new URLSearchParams({
    from: String(first * record),
    to: String((last - 1) * record),
    every: String(every),
    format: 'bdata',
  });
  /** @type {Table} */
  const {rows, columns} = await get(`/api/sessions/${encodeURIComponent(session)}/data?${query}`);
  if (rows === 0) return; // gone back beyond them meanwhile
  if (names.some((name) => !(name in columns))) throw new Error('other columns by now');
  const values = names.map((name) => doubles(columns[name].bdata));
  const start = Math.round(values[names.indexOf('t')][0] / record); // the server may have forgotten the oldest
  for (let from = start; from < last; from += PIECE) {
    const count = Math.min(PIECE, last - from);
    const data = new Float32Array(names.length * count);
    values.forEach((column, place) => {
      for (let i = 0; i < count; i += 1)
        data[place * count + i] = column[Math.min(rows - 1, Math.floor((from + i - start) / every))];
    });
    push(from, count, data);
  }
}

/** @param {string} text */
const doubles = (text) => new Float64Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
