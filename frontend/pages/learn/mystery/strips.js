// The strips of a mystery: differences from a healthy copy, what an observer for one suspect leaves of them, its θ̂,
// and on request inputs and readings.

import {fill, h, symbol} from '../../../common/dom.js';
import {named, t} from '../../../i18n/words.js';
import {Strip} from './strip.js';

/** @import {Child} from '../../../types/dom.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {Game} from './game.js' */
/** @import {Line} from './strip.js' */

/** @typedef {{strip: Strip, curves: {values: readonly (number | null)[], look: string}[]}} Shown */

export class Strips {
  /** @param {HTMLElement} host @param {Game} game */
  constructor(host, game) {
    this.host = host;
    this.game = game;
    this.measured = false;
    /** @type {Shown[]} */
    this.shown = [];
    this.built = '';
  }

  /** Draw up to the present time; build the strips anew where others are wanted. */
  draw() {
    const {mystery, place, language} = this.game;
    const suspect = mystery.choices.some(({channel}) => channel === place.choice) ? place.choice : '';
    const wanted = `${mystery.seed} ${suspect} ${this.measured} ${language}`;
    if (wanted !== this.built) this.build(suspect);
    this.built = wanted;
    /** @type {Line[]} */
    const lines = place.claims.map(({t: at}) => ({t: at, look: 'claim'}));
    if (place.onset !== null && place.choice !== 'none') lines.push({t: place.onset, look: 'began'});
    this.shown.forEach(({strip, curves}, at) =>
      strip.draw({
        curves,
        shown: place.now,
        lines: lines.map((line) =>
          at === 0 && line.look === 'began' ? {...line, words: t('page.mystery.began-here')} : line,
        ),
      }),
    );
  }

  /** @param {string} suspect */
  build(suspect) {
    const {mystery} = this.game;
    const {columns} = mystery;
    const healthy = columns.filter(({of, observer}) => of === 'residual' && observer === '');
    const theta = columns.find(({of, observer}) => of === 'theta' && observer === suspect);
    const others = this.measured ? columns.filter(({of}) => of === 'u' || of === 'y') : [];
    const count = healthy.length + (theta ? 1 : 0) + others.length;
    const height = innerWidth < 960 ? 110 : Math.max(92, Math.min(320, Math.round((innerHeight - 230) / count)));
    this.shown = [
      ...healthy.map((column) => {
        const left = columns.find(
          ({of, observer, subject}) => of === 'residual' && observer === suspect && subject === column.subject,
        );
        const curves = [{values: column.values, look: suspect ? 'healthy' : 'difference'}];
        if (suspect && left) curves.push({values: left.values, look: 'left'});
        return this.strip(column, difference(column.subject), t('page.mystery.difference'), curves, height);
      }),
      ...(theta ? [this.strip(theta, estimate(), this.title(suspect), [curve(theta, 'left')], height)] : []),
      ...others.map((column) =>
        this.strip(
          column,
          symbol(column.subject),
          column.of === 'u' ? t('page.mystery.input') : t('page.mystery.reading'),
          [curve(column, 'plain')],
          height,
        ),
      ),
    ];
    const last = this.shown.at(-1);
    if (last) last.strip.options.axis = true;
    fill(
      this.host,
      this.shown.map(({strip}) => strip.element),
    );
  }

  /** A tenth of the sizes that may be answered: what is smaller is noise. @param {string} channel */
  least(channel) {
    const choice = this.game.mystery.choices.find((one) => one.channel === channel);
    return choice ? 0.1 * (choice.high - choice.low) : 1e-3;
  }

  /** @param {string} channel */
  title(channel) {
    const choice = this.game.mystery.choices.find((one) => one.channel === channel);
    return t('page.mystery.if-it-were', {name: named(choice?.title)});
  }

  /**
   * @param {service.MysteryColumn} column
   * @param {Child} sign
   * @param {string} words
   * @param {Shown['curves']} curves
   * @param {number} height
   * @returns {Shown}
   */
  strip(column, sign, words, curves, height) {
    const unit = column.unit ? `${words}, ${column.unit}` : words;
    const strip = new Strip({
      label: [h('span', {class: 'strip-sign', lang: 'en'}, sign), h('span', {class: 'soft'}, unit)],
      words: `${column.subject}: ${unit}`,
      end: this.game.mystery.end,
      record: this.game.mystery.record,
      height,
      least: column.of === 'theta' ? this.least(column.subject) : 2.5 * roughness(column.values),
      axis: false,
      point: (at) => this.game.pointAt(at),
    });
    return {strip, curves};
  }
}

/** @param {service.MysteryColumn} column @param {string} look */
const curve = ({values}, look) => ({values, look});

/** @param {string} subject */
const difference = (subject) => [symbol(subject), ' − ', symbol(subject, true)];

const estimate = () => symbol('theta', true);

/**
 * The noise of a column: from row to row, in its first tenth, before anything happens.
 * @param {readonly (number | null)[]} values
 */
export function roughness(values) {
  const first = values.slice(0, Math.max(10, Math.floor(values.length / 10))).map((value) => value ?? 0);
  const sum = first.slice(1).reduce((total, value, row) => total + (value - first[row]) ** 2, 0);
  return Math.sqrt(sum / (2 * (first.length - 1))) || Math.abs(first[0]) * 0.05 || 1e-3;
}
