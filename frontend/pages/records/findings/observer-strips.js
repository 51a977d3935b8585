// Strips of observers on a record: θ̂ of each channel with its band, the outputs with ŷ, and the residuals. Pure but
// for the symbols.

import {h, symbol} from '../../../common/dom.js';
import {brief} from '../../../common/names.js';
import {named, t} from '../../../i18n/words.js';
import {colourOf, repeats} from '../../../widgets/line-style.js';
import {WIDE} from '../numbers.js';

/** @import {Columns, Plant, Preview, RecordRun, Strip, StripCurve} from '../types.js' */

/**
 * The observers of all shown runs, in the order of their colours; those of compared runs are dashed.
 * @param {readonly RecordRun[]} runs
 */
export const shownObservers = (runs) =>
  runs
    .filter((one) => one.shown)
    .flatMap(({columns, labels, id}, place) =>
      labels.map((label) => ({run: id, label, columns, title: place === 0 ? label : `${label} (${id.slice(0, 6)})`})),
    )
    .map((one, place) => ({...one, colour: colourOf(place), dashed: repeats(place)}));

/** @typedef {ReturnType<typeof shownObservers>[number]} ShownObserver */

/**
 * @param {readonly ShownObserver[]} observers
 * @param {Plant} plant
 * @returns {Strip[]}
 */
export function estimateStrips(observers, plant) {
  return plant.channels
    .map(({name, title, unit}) => ({
      key: `theta.${name}`,
      label: symbol(name),
      title: brief(named(title)),
      unit: unit ?? '',
      low: [],
      high: [],
      curves: observers.map((one) => estimate(one, name)).filter((one) => one !== null),
      zero: true,
    }))
    .filter(({curves}) => curves.length > 0);
}

/** @param {ShownObserver} observer @param {string} name @returns {StripCurve | null} */
function estimate({columns, label, colour, dashed}, name) {
  const values = columns[`${label}.theta.${name}`];
  if (!values) return null;
  const sigma = columns[`${label}.sigma.${name}`];
  /** @param {number} sign */
  const side = (sign) =>
    sigma?.map((one, k) => (one === null || values[k] === null ? null : Number(values[k]) + sign * WIDE * one));
  return {t: columns.t, values, low: side(-1), high: side(1), colour, dashed};
}

/**
 * The residuals y − ŷ in the standard deviation of the noise.
 * @param {readonly ShownObserver[]} observers
 * @param {Plant} plant
 * @param {{[output: string]: number}} noise   by output
 * @returns {Strip[]}
 */
export function residualStrips(observers, plant, noise) {
  return plant.outputs
    .map(({name}) => ({
      key: `residual.${name}`,
      label: h('span', {class: 'math'}, symbol(name), ' − ŷ'),
      title: t('page.records.residual'),
      unit: noise[name] > 0 ? 'σ' : '',
      low: [],
      high: [],
      small: true,
      curves: observers.map((one) => residual(one, name, noise[name] > 0 ? noise[name] : 1)),
      limits: noise[name] > 0 ? WIDE : undefined,
    }))
    .filter(({curves}) => curves.some((one) => one.values.some((value) => value !== null)));
}

/** @param {ShownObserver} observer @param {string} name @param {number} scale @returns {StripCurve} */
function residual({columns, label, colour, dashed}, name, scale) {
  const [y, own] = [columns[`y.${name}`], columns[`${label}.y.${name}`]];
  const values = columns.t.map((_, k) => {
    const [measured, estimated] = [y?.[k] ?? null, own?.[k] ?? null];
    return measured === null || estimated === null ? null : (measured - estimated) / scale;
  });
  return {t: columns.t, values, colour, dashed};
}

/**
 * Curves of ŷ over the strips of the readings.
 * @param {readonly Strip[]} strips   of the preview, by the names of quantities
 * @param {readonly ShownObserver[]} observers
 * @param {Preview} preview
 * @returns {Strip[]}
 */
export function withEstimates(strips, observers, preview) {
  const outputs = new Set(preview.series.filter(({role}) => role === 'output').map(({name}) => name));
  return strips.map((strip) => {
    if (!outputs.has(strip.key)) return strip;
    const curves = observers
      .filter(({columns, label}) => columns[`${label}.y.${strip.key}`])
      .map(({columns, label, colour, dashed}) => ({
        t: columns.t,
        values: columns[`${label}.y.${strip.key}`],
        colour,
        dashed,
      }));
    return {...strip, curves};
  });
}

/**
 * The innovations of the service's filter, thinned to intervals of equal length.
 * @param {import('../../../types/service.js').Innovations | null | undefined} innovations
 * @param {Plant} plant
 * @param {{count: number, duration: number}} grid
 * @returns {Strip[]}
 */
export function innovationStrips(innovations, plant, {count, duration}) {
  if (!innovations || innovations.t.length === 0) return [];
  const {t: times, low, high} = innovations;
  const size = Math.max(1, Math.min(count, times.length));
  return plant.outputs
    .filter(({name}) => low[name])
    .map(({name}) => {
      /** @type {[(number | null)[], (number | null)[]]} */
      const [least, largest] = [Array(size).fill(null), Array(size).fill(null)];
      times.forEach((at, place) => {
        const [a, b] = [low[name][place], high[name][place]];
        if (a === null || b === null) return;
        const k = Math.min(size - 1, Math.floor((at / (duration || 1)) * size));
        least[k] = Math.min(least[k] ?? Infinity, a);
        largest[k] = Math.max(largest[k] ?? -Infinity, b);
      });
      return {
        key: `innovation.${name}`,
        label: h('span', {class: 'math'}, h('i', {}, 'ν'), ' ', symbol(name)),
        title: t('page.records.innovation'),
        unit: 'σ',
        low: least,
        high: largest,
        bridged: 3,
        small: true,
        limits: WIDE,
      };
    });
}
