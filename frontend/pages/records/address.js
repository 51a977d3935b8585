// The address of a record: its id and the name of its plant in the query; with changes of the mapping, settings or a
// plant of one's own all of them, compressed into the fragment, which never leaves the browser.
//
//   /records/?record=<id>&plant=dts200&step=3
//   /records/?record=<id>&step=2#r=<base64url of deflate of {plant, mapping, settings}>

import {pack, unpack} from '../../live/state/permalink.js';

/** @import * as service from '../../types/service.js' */
/** @import {PlantChoice, Settings} from './types.js' */
/**
 * @typedef {object} RecordLink
 * @property {string | null} record
 * @property {PlantChoice | null} plant
 * @property {service.ColumnMapping | null} mapping   null: the guess
 * @property {Settings | null} settings   null: the defaults
 * @property {number} step
 */

/**
 * @param {RecordLink} link
 * @returns {Promise<string>}
 */
export async function write({record, plant, mapping, settings, step}) {
  const query = new URLSearchParams();
  if (record) query.set('record', record);
  if (typeof plant === 'string') query.set('plant', plant);
  if (step > 1) query.set('step', String(step));
  const rest = {...(plant && typeof plant === 'object' ? {plant} : {}), mapping, settings};
  const packed = Object.values(rest).some((one) => one !== null && one !== undefined);
  const search = query.size ? `?${query}` : '';
  return packed ? `${search}#r=${await pack(rest)}` : search;
}

/**
 * The content of an address. A damaged fragment counts as none.
 * @param {{search: string, hash: string}} from
 * @returns {Promise<RecordLink>}
 */
export async function read(from) {
  const query = new URLSearchParams(from.search);
  const packed = new URLSearchParams(from.hash.slice(1)).get('r');
  const step = Number(query.get('step') ?? 1);
  const {plant, mapping, settings} = packed ? await unpacked(packed) : {};
  return {
    record: query.get('record'),
    plant: plant ?? query.get('plant'),
    mapping: mapping ?? null,
    settings: settings ?? null,
    step: [1, 2, 3].includes(step) ? step : 1,
  };
}

/** @param {string} text @returns {Promise<Partial<RecordLink>>} */
async function unpacked(text) {
  try {
    const content = await unpack(text);
    return content !== null && typeof content === 'object' ? content : {};
  } catch {
    return {};
  }
}
