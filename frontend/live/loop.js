// The one requestAnimationFrame of the page, and the time that the curves' right edge shows.

const TICK = 200; // ms between the numbers beside the curves
const CATCH_UP = 5; // per s: how firmly the edge is drawn to the newest sample

/**
 * Call a listener; one that fails must not stop the others.
 * @param {(now: number) => unknown} fn
 * @param {number} now
 */
function guarded(fn, now) {
  try {
    return fn(now);
  } catch (error) {
    console.error(error);
    return false;
  }
}

/** Runs its listeners in the next frame after `wake()`, and goes on while one of them returns true. */
export function createLoop() {
  /** @type {Set<(now: number) => unknown>} */
  const frames = new Set();
  /** @type {Set<(now: number) => unknown>} */
  const ticks = new Set();
  let pending = 0;
  let ticked = -Infinity;
  /** @type {ReturnType<typeof setTimeout> | 0} */
  let late = 0;

  /** @param {number} now */
  function run(now) {
    pending = 0;
    let more = false;
    for (const fn of frames) more = Boolean(guarded(fn, now)) || more;
    if (now - ticked >= TICK) tick(now);
    // the last numbers are shown, too
    else if (!late) late = setTimeout(() => tick(performance.now()), TICK - (now - ticked));
    if (more) wake();
  }

  /** @param {number} now */
  function tick(now) {
    if (late) clearTimeout(late);
    late = 0;
    ticked = now;
    for (const fn of ticks) guarded(fn, now);
  }

  function wake() {
    if (pending === 0) pending = requestAnimationFrame(run);
  }

  return {
    wake,
    /** @param {(now: number) => unknown} fn */
    onFrame: (fn) => (frames.add(fn), wake(), () => frames.delete(fn)),
    /** @param {(now: number) => unknown} fn */
    onTick: (fn) => (ticks.add(fn), wake(), () => ticks.delete(fn)),
  };
}

/**
 * Time at the right edge. Samples come 30 times a second and in bursts; the edge moves evenly at the session's speed
 * and is drawn gently to the newest sample, so that the picture glides on a screen of any rate.
 */
export class Edge {
  constructor() {
    this.t = 0;
    this.at = 0;
  }

  /**
   * Bring the edge to time `now` (ms); whether it is still on its way.
   * @param {number} now
   * @param {number} newest
   * @param {number} speed
   * @param {boolean} playing
   */
  move(now, newest, speed, playing) {
    const passed = Math.min(0.1, (now - this.at) / 1000);
    this.at = now;
    const far = Math.max(2 * speed * 0.25, 1e-9);
    const gap = newest - this.t;
    if (gap < -far || gap > 4 * far || speed <= 0) this.t = newest;
    else {
      if (playing) this.t += passed * speed;
      this.t += (newest - this.t) * Math.min(1, passed * CATCH_UP * (playing ? 1 : 3));
      if (!playing && Math.abs(newest - this.t) < 1e-3 * far) this.t = newest;
      this.t = Math.min(this.t, newest);
    }
    return playing || this.t !== newest;
  }
}
