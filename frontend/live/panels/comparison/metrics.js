// Figures by which observers are compared, from columns of samples. Pure.

const REACH = 4; // standard deviations that noise may throw an estimate
const LATEST = 0.9; // share of the rows by which an estimate must be there for good

/**
 * Root mean square of the difference of two columns; NaN without rows.
 * @param {Float32Array} a
 * @param {Float32Array} b
 */
export function rmse(a, b) {
  let sum = 0;
  let count = 0;
  for (let k = 0; k < a.length; k += 1) {
    const difference = a[k] - b[k];
    if (difference === difference) {
      sum += difference * difference;
      count += 1;
    }
  }
  return count ? Math.sqrt(sum / count) : NaN;
}

/**
 * When an estimate has come within `within` of the truth to stay, as backend/thetascope/diagnosis/evaluation/metrics.py has it: seconds after `from` until every later row is
 * there; null while it has not, and again where a later row leaves. One that noise still throws out in the last tenth of the rows has not settled.
 * @param {Float64Array} t
 * @param {Float32Array} truth
 * @param {Float32Array} estimate
 * @param {number} from
 * @param {number} within
 * @returns {number | null}
 */
export function settled(t, truth, estimate, from, within) {
  let first = t.length; // of the rows at the end that are all there
  while (first > 0 && Math.abs(estimate[first - 1] - truth[first - 1]) <= within) first -= 1;
  if (first === 0) return 0;
  return first < LATEST * t.length ? t[first] - from : null;
}

/**
 * Whether an estimate has come to the truth, and noise alone keeps throwing it out of `within`: in the later half its mean is there, and single values
 * are not.
 * @param {Float64Array} t
 * @param {Float32Array} truth
 * @param {Float32Array} estimate
 * @param {number} within
 */
export function unsettled(t, truth, estimate, within) {
  const from = Math.floor(t.length / 2);
  let sum = 0;
  let out = 0;
  for (let k = from; k < t.length; k += 1) {
    const error = estimate[k] - truth[k];
    if (error !== error) return false;
    sum += error;
    if (Math.abs(error) > within) out += 1;
  }
  const spread = noise(t.subarray(from), estimate.subarray(from));
  return out > 0 && Math.abs(sum / (t.length - from)) < within / 2 && REACH * spread > within;
}

/**
 * How much an estimate trembles: standard deviation about its straight line over the samples given.
 * @param {Float64Array} t
 * @param {Float32Array} values
 */
export function noise(t, values) {
  let n = 0;
  let st = 0;
  let sv = 0;
  let stt = 0;
  let stv = 0;
  let svv = 0;
  const t0 = t[0] ?? 0;
  for (let k = 0; k < values.length; k += 1) {
    const v = values[k];
    if (v !== v) continue;
    const x = t[k] - t0;
    n += 1;
    st += x;
    sv += v;
    stt += x * x;
    stv += x * v;
    svv += v * v;
  }
  if (n < 3) return NaN;
  const cov = stv - (st * sv) / n;
  const spread = stt - (st * st) / n;
  const left = svv - (sv * sv) / n - (spread > 0 ? (cov * cov) / spread : 0);
  return Math.sqrt(Math.max(0, left) / n);
}
