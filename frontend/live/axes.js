// Axes that are calm: marks at round numbers, and ranges that widen when they must, shrink only after a while, and glide.

const GLIDE = 380; // ms
const PATIENCE = 2500; // ms for which a range must be too wide before it shrinks
const MUCH = 0.5; // how little of it must be used
const ROOM = 0.12; // of the range, added where it widens
const EDGE = 0.015; // of it, which nothing may enter for long
const still = matchMedia('(prefers-reduced-motion: reduce)');

/** The round step of which about `count` fit between two values: 1, 2 or 5 times a power of ten. */
export function niceStep(span, count) {
  if (!(span > 0) || !Number.isFinite(span)) return 1;
  const raw = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(raw));
  const lead = raw / power;
  return power * (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10);
}

/** Multiples of a step between two values. */
export function marks(low, high, step) {
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; i += 1) found.push(i === 0 ? 0 : Number((i * step).toPrecision(12)));
  return found;
}

/** The range of an axis. `aim` is told what should be seen, `move` brings it there. */
export class Range {
  constructor() {
    this.low = NaN;
    this.high = NaN;
    this.target = null;
    this.start = null;
    this.wide = 0; // since when it has been too wide
  }

  /** Values between low and high should be seen. `at once` where the old range means nothing (another plant, another window). */
  aim(low, high, now, atOnce = false) {
    if (!(high >= low)) return;
    const span = high - low || Math.abs(high) * 0.1 || 1;
    const step = niceStep(span, 8);
    const wanted = [Math.floor((low - 0.04 * span) / step) * step, Math.ceil((high + 0.04 * span) / step) * step];
    if (this.target === null || atOnce) {
      this.jump(wanted);
      return;
    }
    const [from, to] = this.target;
    const ahead = ROOM * (wanted[1] - wanted[0]); // what has outgrown the axis goes on growing
    const edge = EDGE * (to - from);
    if (low < from + edge || high > to - edge) {
      this.glide([low < from + edge ? wanted[0] - Math.ceil(ahead / step) * step : from, high > to - edge ? wanted[1] + Math.ceil(ahead / step) * step : to], now);
    }
    const used = (wanted[1] - wanted[0]) / (this.target[1] - this.target[0]);
    if (used > MUCH) this.wide = 0;
    else if (this.wide === 0) this.wide = now;
    else if (now - this.wide > PATIENCE) this.glide(wanted, now);
  }

  jump(wanted) {
    this.target = wanted;
    [this.low, this.high] = wanted;
    this.start = null;
    this.wide = 0;
  }

  glide(wanted, now) {
    if (wanted[0] === this.target[0] && wanted[1] === this.target[1]) return;
    if (still.matches) {
      this.jump(wanted);
      return;
    }
    this.target = wanted;
    this.start = {at: now, low: this.low, high: this.high};
    this.wide = 0;
  }

  /** Bring the range to where it is at time now; whether it is still moving. */
  move(now) {
    if (this.start === null) return false;
    const share = Math.min(1, (now - this.start.at) / GLIDE);
    const eased = 1 - (1 - share) ** 3;
    this.low = this.start.low + (this.target[0] - this.start.low) * eased;
    this.high = this.start.high + (this.target[1] - this.start.high) * eased;
    if (share === 1) this.start = null;
    return share < 1;
  }
}

/**
 * What of a column deserves to be seen between two rows: [low, high] without the outermost `share` of its bins on either side. An observer's
 * start or a fault elsewhere throws an estimate far off for a moment; the axis does not follow it there.
 */
export function extent(samples, name, first, last, share) {
  const power = samples.power(first, last, 120);
  const source = samples.source(name, power);
  if (!source || last <= first) return null;
  const each = source.rows;
  const low = [];
  const high = [];
  for (let bin = Math.floor(first / each); bin * each < last; bin += 1) {
    const a = source.low[bin & source.mask];
    const b = source.high[bin & source.mask];
    if (a === a) low.push(a);
    if (b === b) high.push(b);
  }
  if (low.length === 0) return null;
  if (share === 0) return [Math.min(...low), Math.max(...high)];
  low.sort((a, b) => a - b);
  high.sort((a, b) => a - b);
  return [low[Math.floor(share * low.length)], high[Math.ceil((1 - share) * high.length) - 1]];
}
