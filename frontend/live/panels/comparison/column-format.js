// The form of the numbers in a column.

import {power} from '../../../widgets/number-format.js';

/**
 * One form for all numbers of a column, so that they can be compared and none changes its width: once it has had to
 * be finer it stays so.
 */
export class Form {
  constructor() {
    this.places = 0;
    this.powers = false;
  }

  /** @param {number[]} values */
  take(values) {
    for (const value of values) {
      if (!(value > 0)) continue;
      this.places = Math.max(this.places, 1 - Math.floor(Math.log10(value)));
      this.powers ||= this.places > 5 || value >= 1e5;
    }
  }

  /** @param {number} value */
  write(value) {
    if (!Number.isFinite(value)) return '–';
    return this.powers ? power(value) : value.toFixed(this.places);
  }
}
