// The truth that the panel shows: that of the session, with the edits on their way to it; or a draft, while its further
// states differ from those that run, which only a new start can change.

import {complete} from '../../../widgets/truth-differences.js';
import {pathOf, same, sameStates} from './truth-edits.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Edit, Truth} from './truth-edits.js' */

/**
 * @typedef {object} Options
 * @property {(truth: Truth) => Promise<unknown>} send   commands a truth; rejects with a refusal
 * @property {() => void} changed                        called after every change of what is shown
 * @property {(path: string, error: unknown) => void} refused   `path`: the element that the refusal is about
 * @property {number} [pause]                            ms between two commands
 */

export class TruthSource {
  /** @param {Options} options */
  constructor({send, changed, refused, pause = 150}) {
    this.send = send;
    this.changed = changed;
    this.refused = refused;
    this.pause = pause;
    /** @type {Truth} the session's */
    this.running = complete(null);
    this.reset(this.running);
  }

  /**
   * Forget everything: another session, or another time.
   * @param {Truth} truth
   */
  reset(truth) {
    this.running = truth;
    /** @type {Truth | null} */
    this.draft = null;
    /** @type {Map<string, Edit>} edits that wait, by path; of one that is dragged the newest counts */
    this.waiting = new Map();
    /** The sender of this session: an answer to an earlier one changes nothing. */
    this.sender = {};
    this.busy = false;
    /** @type {Truth | null} the one that is being sent */
    this.sent = null;
    /** @type {Truth | null} the session's, as it came after the last answer */
    this.later = null;
  }

  /** The truth as it is shown: with everything that was edited. */
  get shown() {
    if (this.draft) return this.draft;
    return [...this.waiting.values()].reduce((truth, edit) => edit(truth), this.sent ?? this.running);
  }

  /**
   * Take over the truth of the session, unless an edit is on its way to it.
   * @param {Truth} truth
   */
  follow(truth) {
    this.later = truth;
    if (this.busy || this.waiting.size > 0 || same(truth, this.running)) return;
    this.running = truth;
    if (this.draft && sameStates(this.draft, truth) && same(this.draft, truth)) this.draft = null;
    this.changed();
  }

  /**
   * Change one element; `path` names it.
   * @param {string} path
   * @param {Edit} edit
   */
  change(path, edit) {
    const next = edit(this.shown);
    if (this.draft || !sameStates(next, this.running)) {
      this.draft = next;
      if (sameStates(next, this.running)) {
        this.draft = null;
        this.waiting.set('', () => next);
      }
    } else {
      this.waiting.delete(path);
      this.waiting.set(path, edit);
    }
    this.changed();
    this.work();
  }

  /** Give the draft up. */
  discard() {
    this.draft = null;
    this.changed();
    this.work();
  }

  /** Send the edits that wait, one after another. */
  async work() {
    const mine = this.sender;
    if (this.busy || this.draft) return;
    const [first] = this.waiting;
    if (!first) return;
    const [path, edit] = first;
    this.waiting.delete(path);
    this.busy = true;
    this.sent = edit(this.running);
    const began = performance.now();
    try {
      await this.send(this.sent);
      if (mine === this.sender) this.running = this.sent;
    } catch (error) {
      if (mine === this.sender) this.refused(pathOf(/** @type {{field?: string}} */ (error)) || path, error);
    }
    if (mine !== this.sender) return;
    [this.sent, this.later] = [null, null];
    this.changed();
    await new Promise((done) => setTimeout(done, Math.max(0, this.pause - (performance.now() - began))));
    if (mine !== this.sender) return;
    this.busy = false;
    if (this.later) this.follow(this.later);
    this.work();
  }
}
