// The samples of a session in the browser: the newest rows at full rate, all of them as minima and maxima of 4, 16, 64
// … rows.
//
// Memory is bounded: every array is a ring whose capacity is a power of two, so a row's place is `row & mask`. Minima
// and maxima belong to absolute row numbers, not to the screen: a curve that scrolls does not shimmer.

/** @import {DerivedColumn, Source} from '../types.js' */

const BITS = 2; // each level gathers 4 of the one below
const LEVELS = 9; // up to 4⁹ = 262 144 rows in one
const BUCKETS = 16384; // per level: more than a screen has columns of pixels
const SMALLEST = 4096;
const MEMORY = 64e6; // bytes for the rows at full rate

class Column {
  /** @param {number} capacity */
  constructor(capacity) {
    this.values = new Float32Array(capacity).fill(NaN);
    /** @type {Float32Array<ArrayBuffer>[]} */
    this.low = [];
    /** @type {Float32Array<ArrayBuffer>[]} */
    this.high = [];
    for (let level = 0; level < LEVELS; level += 1) {
      this.low.push(new Float32Array(256).fill(NaN));
      this.high.push(new Float32Array(256).fill(NaN));
    }
  }

  /**
   * Gather rows first … last − 1 into all levels; `rows` is where the known rows end.
   * @param {number} first
   * @param {number} last
   * @param {number} rows
   */
  gather(first, last, rows) {
    let {values: low, values: high} = this;
    let from = first;
    let to = last - 1;
    let end = rows; // entries of the level below
    for (let level = 0; level < LEVELS; level += 1) {
      from >>= BITS;
      to >>= BITS;
      this.low[level] = grown(this.low[level], Math.min(to + 1, BUCKETS));
      this.high[level] = grown(this.high[level], Math.min(to + 1, BUCKETS));
      gatherLevel(low, high, this.low[level], this.high[level], from, to, end);
      low = this.low[level];
      high = this.high[level];
      end = ((end - 1) >> BITS) + 1;
    }
  }
}

/**
 * A ring of at least this size with the same entries; it must not have wrapped yet.
 * @param {Float32Array<ArrayBuffer>} ring
 * @param {number} size
 * @returns {Float32Array<ArrayBuffer>}
 */
function grown(ring, size) {
  if (ring.length >= size) return ring;
  const larger = new Float32Array(2 ** Math.ceil(Math.log2(size))).fill(NaN);
  larger.set(ring);
  return larger;
}

/**
 * @param {Float32Array} low
 * @param {Float32Array} high
 * @param {Float32Array} lows
 * @param {Float32Array} highs
 * @param {number} from
 * @param {number} to
 * @param {number} end
 */
function gatherLevel(low, high, lows, highs, from, to, end) {
  const mask = low.length - 1;
  const own = lows.length - 1;
  for (let bucket = from; bucket <= to; bucket += 1) {
    let least = NaN;
    let most = NaN;
    const stop = Math.min(end, (bucket + 1) << BITS);
    for (let i = bucket << BITS; i < stop; i += 1) {
      const a = low[i & mask];
      const b = high[i & mask];
      if (!(least <= a)) least = a === a ? a : least; // NaN counts for nothing
      if (!(most >= b)) most = b === b ? b : most;
    }
    lows[bucket & own] = least;
    highs[bucket & own] = most;
  }
}

export class Samples {
  /** @param {number} record  s between rows */
  constructor(record, memory = MEMORY) {
    this.record = record;
    this.memory = memory;
    /** @type {Map<string, Column>} */
    this.columns = new Map();
    /** @type {string[]} names of the columns as they arrive */
    this.sent = [];
    /** @type {DerivedColumn[]} */
    this.derived = [];
    this.rows = 0;
    this.capacity = SMALLEST;
    this.floor = 0; // rows before it were overwritten by rows that are void now
    this.floors = new Array(LEVELS).fill(0); // the same in buckets of each level
    /** @type {number | undefined} of the session, as its messages have it */
    this.epoch = undefined;
    this.held = false; // frames wait for rows that are being fetched
    this.most = SMALLEST;
    this.version = 0; // changes with everything that is to be drawn
  }

  /**
   * The columns that arrive from now on, and those that are computed of them: [{name, of: [names], make: (a, b) =>
   * value}].
   * Samples that are there already under the same name are kept.
   * @param {string[]} names
   * @param {DerivedColumn[]} [derived]
   */
  setColumns(names, derived = []) {
    const known = new Set(names);
    this.sent = [...names];
    this.derived = derived.filter(({of}) => of.every((name) => known.has(name)));
    const all = [...names, ...this.derived.map(({name}) => name)];
    const most = Math.max(SMALLEST, 2 ** Math.floor(Math.log2(this.memory / 4 / Math.max(1, all.length))));
    const wrapped = this.rows > this.capacity || this.floor > 0;
    this.most = wrapped ? this.capacity : Math.max(most, this.capacity); // more columns never throw rows away
    this.columns = new Map(all.map((name) => [name, this.columns.get(name) ?? new Column(this.capacity)]));
    this.version += 1;
  }

  /**
   * Rows from this one on are void.
   * @param {number} row
   */
  truncate(row) {
    if (row < this.rows) {
      this.floor = Math.min(row, this.oldest);
      this.floors = this.floors.map((_, level) => Math.min(row >> (BITS * (level + 1)), this.firstBucket(level)));
      this.rows = row;
    }
    if (this.rows > 0) for (const column of this.columns.values()) column.gather(this.rows - 1, this.rows, this.rows);
    this.version += 1;
  }

  /**
   * Rows `first` … of all columns, one column after the other. Rows that are there already are replaced.
   * @param {number} first
   * @param {number} count
   * @param {Float32Array} data
   */
  push(first, count, data) {
    if (count === 0) return;
    const end = first + count;
    while (end > this.capacity && this.capacity < this.most) this.grow();
    const skip = Math.max(0, count - this.capacity); // of more than fit, the newest
    const gap = Math.min(first - this.rows, this.capacity);
    for (let place = 0; place < this.sent.length; place += 1) {
      const {values} = this.column(this.sent[place]);
      if (gap > 0) for (let row = first - gap; row < first; row += 1) values[row & (this.capacity - 1)] = NaN;
      write(values, first + skip, data.subarray(place * count + skip, (place + 1) * count));
    }
    for (const {name, of, make} of this.derived) this.derive(name, of, make, first + skip, end);
    this.rows = end;
    const from = gap > 0 ? first - gap : first + skip;
    for (const column of this.columns.values()) column.gather(from, end, end);
    this.version += 1;
  }

  /**
   * @param {string} name
   * @param {string[]} of
   * @param {DerivedColumn['make']} make
   * @param {number} first
   * @param {number} end
   */
  derive(name, of, make, first, end) {
    const mask = this.capacity - 1;
    const {values} = this.column(name);
    const [a, b] = of.map((one) => this.column(one).values);
    for (let row = first; row < end; row += 1) values[row & mask] = make(a[row & mask], b?.[row & mask]);
  }

  /**
   * A column that is known to be there.
   * @param {string} name
   */
  column(name) {
    const column = this.columns.get(name);
    if (!column) throw new RangeError(`no column ${name}`);
    return column;
  }

  grow() {
    this.capacity *= 2;
    for (const column of this.columns.values()) column.values = grown(column.values, this.capacity);
  }

  /** @param {string} name */
  has(name) {
    return this.columns.has(name);
  }

  /** First row that is kept at full rate. */
  get oldest() {
    return Math.max(this.floor, this.rows - this.capacity);
  }

  /**
   * The first bucket of a level that is kept.
   * @param {number} level
   */
  firstBucket(level) {
    return Math.max(this.floors[level], ((this.rows - 1) >> (BITS * (level + 1))) - BUCKETS + 1);
  }

  /** Time of the newest row, s. */
  get now() {
    return this.rows === 0 ? 0 : (this.rows - 1) * this.record;
  }

  /** @param {string} name */
  latest(name) {
    return this.value(name, this.rows - 1);
  }

  /**
   * Value of a row, NaN where the buffer has no row, or no longer.
   * @param {string} name
   * @param {number} row
   */
  value(name, row) {
    const column = this.columns.get(name);
    if (!column || row < this.oldest || row >= this.rows || row < 0)
      return column && row >= 0 && row < this.rows ? this.coarse(column, row) : NaN;
    return column.values[row & (this.capacity - 1)];
  }

  /**
   * The value of a row in the finest level that still has it: the middle between minimum and maximum.
   * @param {Column} column
   * @param {number} row
   */
  coarse(column, row) {
    for (let level = 0; level < LEVELS; level += 1) {
      const bucket = row >> (BITS * (level + 1));
      const size = column.low[level].length;
      if (bucket >= this.firstBucket(level)) {
        return (column.low[level][bucket & (size - 1)] + column.high[level][bucket & (size - 1)]) / 2;
      }
    }
    return NaN;
  }

  /** @param {string} name @param {number} t */
  at(name, t) {
    return this.value(name, Math.round(t / this.record));
  }

  /**
   * Copies of the rows that are kept at full rate between two times: {t, v}.
   * @param {string} name
   * @param {number} t0
   * @param {number} t1
   */
  window(name, t0, t1) {
    const column = this.columns.get(name);
    const first = Math.max(this.oldest, Math.ceil(t0 / this.record - 1e-6));
    const last = Math.min(this.rows - 1, Math.floor(t1 / this.record + 1e-6));
    const values = column?.values ?? new Float32Array(0);
    const count = column ? Math.max(0, last - first + 1) : 0;
    const t = new Float64Array(count);
    const v = new Float32Array(count);
    for (let i = 0; i < count; i += 1) {
      t[i] = (first + i) * this.record;
      v[i] = values[(first + i) & (this.capacity - 1)];
    }
    return {t, v};
  }

  /**
   * {min, max, mean, count} between two times; the mean is of the full rate only.
   * @param {string} name
   * @param {number} t0
   * @param {number} t1
   */
  range(name, t0, t1) {
    const {v} = this.window(name, t0, t1);
    let min = Infinity;
    let max = -Infinity;
    let sum = 0;
    let count = 0;
    for (const value of v) {
      if (value !== value) continue;
      if (value < min) min = value;
      if (value > max) max = value;
      sum += value;
      count += 1;
    }
    return count ? {min, max, mean: sum / count, count} : {min: NaN, max: NaN, mean: NaN, count: 0};
  }

  /**
   * How many rows to combine when rows first … last are drawn on a number of pixels, as a power of two. One bin is at
   * least a pixel wide, and its level still reaches back to `first`.
   * @param {number} first
   * @param {number} last
   * @param {number} pixels
   */
  power(first, last, pixels) {
    let power = Math.max(0, Math.ceil(Math.log2(Math.max(1, (last - first) / Math.max(1, pixels)))));
    while (power < BITS * LEVELS && first < this.reach(power)) power += 1;
    return power;
  }

  /**
   * The first row that is known in bins of 2^power rows.
   * @param {number} power
   */
  reach(power) {
    const level = power >> 1;
    return level === 0 ? this.oldest : this.firstBucket(level - 1) << (BITS * level);
  }

  /**
   * The arrays that hold bins of 2^power rows: entry i covers rows i·rows … and is found at i & mask.
   * @param {string} name
   * @param {number} power
   * @returns {Source | null}
   */
  source(name, power) {
    const column = this.columns.get(name);
    if (!column) return null;
    const level = power >> 1;
    const low = level === 0 ? column.values : column.low[level - 1];
    const high = level === 0 ? column.values : column.high[level - 1];
    return {low, high, mask: low.length - 1, rows: 1 << (BITS * level), pair: power % 2 === 1};
  }
}

/**
 * Write values into a ring from a row on.
 * @param {Float32Array} ring
 * @param {number} row
 * @param {Float32Array} values
 */
function write(ring, row, values) {
  const at = row & (ring.length - 1);
  const straight = Math.min(values.length, ring.length - at);
  ring.set(straight === values.length ? values : values.subarray(0, straight), at);
  if (straight < values.length) ring.set(values.subarray(straight), 0);
}
