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
 * When an estimate first comes within `share` of the truth and stays for `hold` seconds: seconds after `from`; null while it has not.
 * @param {Float64Array} t
 * @param {Float32Array} truth
 * @param {Float32Array} estimate
 */
export function settled(t, truth, estimate, from, hold, share = 0.1) {
  let since = null; // row from which it has been there
  for (let k = 0; k < t.length; k += 1) {
    const there = Math.abs(estimate[k] - truth[k]) <= share * Math.abs(truth[k]);
    if (!there) since = null;
    else if (since === null) since = k;
    if (since !== null && t[k] - t[since] >= hold) return Math.max(0, t[since] - from);
  }
  return null;
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
