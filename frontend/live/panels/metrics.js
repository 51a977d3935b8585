// Figures by which observers are compared, from columns of samples. Pure.

/** Root mean square of the difference of two columns; NaN without rows. */
export function rmse(a, b) {
  let sum = 0;
  let count = 0;
  for (let k = 0; k < a.length; k += 1) {
    const difference = a[k] - b[k];
    if (difference === difference) { sum += difference * difference; count += 1; }
  }
  return count ? Math.sqrt(sum / count) : NaN;
}

/**
 * When an estimate comes within `share` of the truth for good: seconds after `from`; null while it is not there.
 * @param {Float64Array} t
 * @param {Float32Array} truth
 * @param {Float32Array} estimate
 */
export function settled(t, truth, estimate, from, share = 0.1, typical = 0) {
  let last = null;
  for (let k = 0; k < t.length; k += 1) {
    const room = share * Math.max(Math.abs(truth[k]), typical);
    if (!(Math.abs(estimate[k] - truth[k]) <= room)) last = k;
  }
  if (t.length === 0 || last === t.length - 1) return null;
  return last === null ? 0 : Math.max(0, t[last + 1] - from);
}

/** How much an estimate trembles: standard deviation about its straight line over the samples given. */
export function noise(t, values) {
  let n = 0; let st = 0; let sv = 0; let stt = 0; let stv = 0; let svv = 0;
  const t0 = t[0] ?? 0;
  for (let k = 0; k < values.length; k += 1) {
    const v = values[k];
    if (v !== v) continue;
    const x = t[k] - t0;
    n += 1; st += x; sv += v; stt += x * x; stv += x * v; svv += v * v;
  }
  if (n < 3) return NaN;
  const cov = stv - (st * sv) / n;
  const spread = stt - (st * st) / n;
  const left = svv - (sv * sv) / n - (spread > 0 ? (cov * cov) / spread : 0);
  return Math.sqrt(Math.max(0, left) / n);
}
