// Rows that were not sent because this page was too far behind: fetched thinned out, so that the curves have no hole.

import {get} from '../api.js';

const MOST = 4000; // rows asked for
const PIECE = 8192; // rows handed on at once

/** Fetch rows first … last − 1 of a session and give them to `push(first, count, data)` as if they had been sent, each held until the next. */
export async function fetchMissed({session, names, record, first, last, push}) {
  const every = Math.max(1, Math.ceil((last - first) / MOST));
  const query = new URLSearchParams({from: first * record, to: (last - 1) * record, every, format: 'bdata'});
  const {rows, columns} = await get(`/api/sessions/${encodeURIComponent(session)}/data?${query}`);
  if (rows === 0 || names.some((name) => !(name in columns))) return;
  const values = names.map((name) => doubles(columns[name].bdata));
  const start = Math.round(values[names.indexOf('t')][0] / record); // the server may have forgotten the oldest
  for (let from = start; from < last; from += PIECE) {
    const count = Math.min(PIECE, last - from);
    const data = new Float32Array(names.length * count);
    values.forEach((column, place) => {
      for (let i = 0; i < count; i += 1) data[place * count + i] = column[Math.min(rows - 1, Math.floor((from + i - start) / every))];
    });
    push(from, count, data);
  }
}

const doubles = (text) => new Float64Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
