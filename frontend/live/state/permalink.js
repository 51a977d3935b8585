// The address holds the session: the short form `?experiment=id` while nothing was changed, else everything that makes
// its numbers, compressed into the fragment (which never leaves the browser). `t` is the time at which a copied link
// opens it.
//
//   /?experiment=zhao-2012&t=42
//   /#s=<base64url of deflate of {experiment, changed: {spec fields that differ}, t}>
//   /?session=<id>            watch this very session (no control)

/** @import {Experiment} from '../types.js' */

/**
 * The content of an address.
 * @typedef {object} LinkContent
 * @property {string | null} session
 * @property {string | null} experiment
 * @property {number} t   s
 * @property {Partial<Experiment>} [changed]   fields that differ from the library experiment
 * @property {Experiment} [spec]
 * @property {boolean} [play]   whether it plays when it is open
 */

const PROSE = ['figures', 'errata', 'description', 'source'];

/** @param {unknown} a @param {unknown} b */
const same = (a, b) => JSON.stringify(sorted(a)) === JSON.stringify(sorted(b));

/** @param {unknown} value @returns {unknown} */
function sorted(value) {
  if (Array.isArray(value)) return value.map(sorted);
  if (value === null || typeof value !== 'object') return value;
  const entries = Object.entries(value).sort(([a], [b]) => (a < b ? -1 : 1));
  return Object.fromEntries(entries.map(([key, item]) => [key, sorted(item)]));
}

/**
 * The fields of a spec that the library's experiment does not have so. `base` has its plant in full.
 * @param {Experiment} spec
 * @param {Experiment} base
 * @returns {Partial<Experiment>}
 */
export function changed(spec, base) {
  /** @type {{[field: string]: unknown}} */
  const known = base;
  return Object.fromEntries(
    Object.entries(spec).filter(([key, value]) => !PROSE.includes(key) && !same(value, known[key])),
  );
}

/**
 * The address of a spec at a time. `base`: the library's experiment it began with, plant in full, or null.
 * @param {{spec: Experiment, t: number, experiment: string | null, base: Experiment | null}} session
 * @returns {Promise<string>}
 */
export async function write({spec, t, experiment, base}) {
  const time = Number(t.toPrecision(12));
  if (base) {
    const differs = changed(spec, base);
    if (Object.keys(differs).length === 0)
      return `?experiment=${encodeURIComponent(experiment ?? '')}${time > 0 ? `&t=${time}` : ''}`;
    return `#s=${await pack({experiment, changed: differs, t: time})}`;
  }
  return `#s=${await pack({spec, t: time})}`;
}

/**
 * The content of an address: {experiment, changed?, spec?, t, session}. `from` is a Location or URL.
 * @throws {Error} where the fragment is damaged
 * @param {{search: string, hash: string}} from
 * @returns {Promise<LinkContent>}
 */
export async function read(from) {
  const query = new URLSearchParams(from.search);
  const fragment = new URLSearchParams(from.hash.slice(1)).get('s');
  const t = Number(query.get('t') ?? 0);
  const request = {
    session: query.get('session'),
    experiment: query.get('experiment'),
    t: Number.isFinite(t) && t > 0 ? t : 0,
  };
  if (!fragment) return request;
  const content = await unpack(fragment);
  if (!isSession(content)) throw new Error('the link holds no session');
  return {...request, ...content};
}

/**
 * Whether a fragment holds an experiment, and how it differs.
 * @param {unknown} content
 * @returns {content is Partial<LinkContent>}
 */
function isSession(content) {
  if (!isObject(content)) return false;
  const {spec, changed: differs, experiment, t = 0} = content;
  return (isObject(spec) || (isObject(differs) && typeof experiment === 'string')) && Number.isFinite(t);
}

/**
 * @param {unknown} value
 * @returns {value is {[name: string]: unknown}}
 */
const isObject = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);

/**
 * The spec that an address with a fragment means; `load(id)` gives a library experiment with its plant in full.
 * @param {LinkContent} content
 * @param {(id: string) => Promise<Experiment>} load
 * @returns {Promise<Experiment | null>}
 */
export async function specOf(content, load) {
  if (content.spec) return content.spec;
  if (!content.changed || !content.experiment) return null;
  return {...(await load(content.experiment)), ...content.changed};
}

/** Bytes of the largest session that a link is unpacked to; a service takes none of more than 2 MB. */
const LARGEST = 4 * 1024 * 1024;

/**
 * The bytes that leave a stream. A few kilobytes of a hostile link would unpack to gigabytes.
 * @throws {Error} for more than LARGEST bytes
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @param {CompressionStream | DecompressionStream} through
 */
async function pipe(bytes, through) {
  const reader = new Blob([bytes]).stream().pipeThrough(through).getReader();
  const parts = [];
  for (let size = 0, part = await reader.read(); !part.done; part = await reader.read()) {
    size += part.value.length;
    if (size > LARGEST) {
      await reader.cancel();
      throw new Error('the link holds too much');
    }
    parts.push(part.value);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/** @param {unknown} value */
export async function pack(value) {
  const bytes = await pipe(new TextEncoder().encode(JSON.stringify(value)), new CompressionStream('deflate-raw'));
  let text = '';
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** @param {string} text @returns {Promise<unknown>} */
export async function unpack(text) {
  const bytes = Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
  return JSON.parse(new TextDecoder().decode(await pipe(bytes, new DecompressionStream('deflate-raw'))));
}
