// A round of Mystery: a record that plays, a half-made answer, accusations, and the solution after the answer.

import {get, post} from '../../../common/api.js';
import {fill, h, query} from '../../../common/dom.js';
import {asSentence, language, refusalWords, t} from '../../../i18n/words.js';
import {anySeed, fresh, keepPlace, keptPlace, markPlayed, played} from './place.js';
import {Question} from './question.js';
import {drawResult} from './result.js';
import {Strips} from './strips.js';
import {digits} from './times.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Place} from './place.js' */

const SPEEDS = [1, 3, 10];
const LASTS = 60; // s that a record takes at the lowest speed

/** @type {service.Mystery} */
const NOTHING = {
  seed: '',
  setup: '',
  title: {en: '', zh: ''},
  plant: {en: '', zh: ''},
  end: 1,
  record: 1,
  ramp: 1,
  choices: [],
  columns: [],
};

/** @param {string} seed @param {string} setup */
const addressOf = (seed, setup) => `?seed=${seed}${setup ? `&setup=${encodeURIComponent(setup)}` : ''}`;

export class Game {
  constructor() {
    /** @type {Place} */
    this.place = fresh('');
    this.mystery = NOTHING;
    /** @type {service.MysterySolution | null} */
    this.solution = null;
    this.seed = '';
    /** Id of the set-up that was chosen; '' where the seed draws it. */
    this.setup = '';
    /** @type {readonly service.MysterySetupLine[]} */
    this.setups = [];
    this.playing = false;
    this.speed = SPEEDS[1];
    this.sending = false;
    /** @type {unknown} */
    this.problem = null;
    this.last = 0;
    this.turn = 0;
    this.main = query('#main');
    this.card = h('section', {class: 'card mystery-card', 'aria-labelledby': 'mystery-title'});
    this.transport = h('div', {class: 'mystery-transport'});
    this.strips = new Strips(h('div', {class: 'mystery-strips'}), this);
    this.question = new Question(this.card, this);
    this.clock = h('span', {class: 'mystery-clock'});
  }

  get language() {
    return language();
  }

  /** Open the mystery of the address, or any. @returns {Promise<void>} */
  async open() {
    const turn = (this.turn += 1);
    const query = new URLSearchParams(location.search);
    this.setup = query.get('setup') ?? '';
    if (!query.get('seed')) {
      const easiest = played().seeds.length ? '' : (this.setups[0]?.id ?? '');
      history.replaceState(null, '', addressOf(anySeed(), this.setup || easiest));
      return this.open();
    }
    this.seed = query.get('seed')?.toLowerCase() ?? '';
    this.playing = false;
    this.solution = null;
    this.problem = null;
    this.mystery = NOTHING;
    this.place = keptPlace(this.name);
    fill(this.main, h('p', {class: 'soft mystery-wait', role: 'status'}, t('page.mystery.opening')));
    try {
      const mystery = await get(this.path(''));
      if (turn !== this.turn) return;
      this.mystery = mystery;
    } catch (error) {
      return this.refuse(error);
    }
    if (this.place.answer) return this.send(this.place.answer);
    this.show();
  }

  /** @param {unknown} error */
  refuse(error) {
    const {problem, remedy} = refusalWords(error);
    fill(
      this.main,
      h(
        'section',
        {class: 'card mystery-refused', role: 'alert'},
        h('p', {}, `${asSentence(problem)} ${asSentence(remedy)}`),
        h('button', {type: 'button', class: 'run', onclick: () => this.another()}, t('page.mystery.another')),
      ),
    );
  }

  show() {
    if (!this.mystery.seed) return;
    if (this.solution) {
      drawResult(this.main, this);
      return;
    }
    if (!this.main.contains(this.card))
      fill(
        this.main,
        h(
          'div',
          {class: 'mystery'},
          this.card,
          h('div', {class: 'mystery-record'}, this.transport, h('section', {class: 'card'}, this.strips.host)),
        ),
      );
    this.question.draw();
    this.drawTransport();
    this.strips.draw();
    this.tell();
  }

  drawTransport() {
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.keep : undefined;
    const over = this.place.now >= this.mystery.end;
    fill(
      this.transport,
      h(
        'button',
        {
          type: 'button',
          class: 'run mystery-play',
          'data-keep': 'play',
          disabled: over,
          onclick: () => this.toggle(),
        },
        this.playing ? t('page.mystery.pause') : over ? t('page.mystery.over') : t('page.mystery.play'),
      ),
      h(
        'div',
        {class: 'mystery-speeds', role: 'group', 'aria-label': t('page.mystery.speed')},
        SPEEDS.map((speed) =>
          h(
            'button',
            {
              type: 'button',
              class: 'quiet',
              'data-keep': `speed-${speed}`,
              'aria-pressed': String(speed === this.speed),
              onclick: () => this.setSpeed(speed),
            },
            `${speed}×`,
          ),
        ),
      ),
      this.clock,
      h('span', {class: 'grow'}),
      h(
        'button',
        {
          type: 'button',
          class: 'quiet',
          'data-keep': 'measured',
          'aria-pressed': String(this.strips.measured),
          onclick: () => this.measured(),
        },
        t('page.mystery.measured'),
      ),
    );
    if (focused) /** @type {HTMLElement | null} */ (this.transport.querySelector(`[data-keep="${focused}"]`))?.focus();
  }

  measured() {
    this.strips.measured = !this.strips.measured;
    this.drawTransport();
    this.strips.draw();
  }

  /** @param {number} speed */
  setSpeed(speed) {
    this.speed = speed;
    this.drawTransport();
  }

  /** The time, which changes while it plays. */
  tell() {
    const words = t('page.mystery.clock', {now: digits(this.place.now, this.mystery.end), end: this.mystery.end});
    if (this.clock.textContent !== words) this.clock.textContent = words;
    this.question.follow();
  }

  toggle() {
    if (this.place.now >= this.mystery.end || this.solution) return;
    this.playing = !this.playing;
    this.last = performance.now();
    keepPlace(this.place);
    this.drawTransport();
    if (this.playing) requestAnimationFrame((time) => this.step(time));
  }

  /** @param {number} time of the frame in ms */
  step(time) {
    if (!this.playing) return;
    const passed = Math.min(0.25, Math.max(0, (time - this.last) / 1000));
    this.last = time;
    const {end} = this.mystery;
    this.place.now = Math.min(end, this.place.now + (passed * this.speed * end) / LASTS);
    this.strips.draw();
    this.tell();
    if (this.place.now >= end) {
      this.playing = false;
      keepPlace(this.place);
      this.drawTransport();
      this.question.draw();
      return;
    }
    requestAnimationFrame((next) => this.step(next));
  }

  /** Change the half-made answer. @param {Partial<Place>} change */
  set(change) {
    Object.assign(this.place, change);
    this.problem = null;
    keepPlace(this.place);
    this.question.draw();
    this.strips.draw();
  }

  /** Somebody pointed at a time: it may have begun there. @param {number} t */
  pointAt(t) {
    if (this.place.choice === 'none' || this.place.choice === 'alike') return;
    const {record} = this.mystery;
    const row = Math.round(Math.min(Math.max(t, 0), this.place.now) / record);
    this.set({onset: Number((row * record).toPrecision(10))});
  }

  /** What the present choice names: a channel, several, or '' for none. */
  get key() {
    const {choice, alike} = this.place;
    if (choice === 'alike') return [...alike].sort().join();
    return choice === 'none' ? '' : choice;
  }

  /** Whether the present choice can be accused: it names something that was not named last. */
  get accusable() {
    const {choice, alike, claims} = this.place;
    if (choice === '' || choice === 'none' || (choice === 'alike' && alike.length < 2)) return false;
    return claims.at(-1)?.key !== this.key;
  }

  accuse() {
    if (!this.accusable || this.place.claims.length >= 20) return;
    this.set({claims: [...this.place.claims, {key: this.key, t: this.seenUntil()}]});
  }

  /** The row up to which the record was seen, in s. */
  seenUntil() {
    const {record} = this.mystery;
    return Number((Math.floor(this.place.now / record + 1e-6) * record).toPrecision(10));
  }

  /** Whether there is an answer that could be sent. */
  get ready() {
    const {choice, alike} = this.place;
    return choice !== '' && (choice !== 'alike' || alike.length > 1);
  }

  /** @returns {service.ChallengeAnswer} */
  answer() {
    const {choice, alike, claims, size, onset} = this.place;
    const last = claims.at(-1);
    const accused = claims
      .filter(({key}) => key !== this.key && !key.includes(','))
      .map(({key, t: at}) => ({channel: key, at}));
    const one = choice !== 'none' && choice !== 'alike';
    return {
      verdict: one ? 'channel' : choice === 'none' ? 'none' : 'cannot-be-told',
      channel: one ? choice : null,
      alike: choice === 'alike' ? alike : [],
      onset: one ? onset : null,
      size: one ? size : null,
      at: last && last.key === this.key ? last.t : this.seenUntil(),
      accused,
    };
  }

  async finish() {
    if (!this.ready || this.sending) return;
    this.playing = false;
    const answer = this.answer();
    this.place.answer = answer;
    keepPlace(this.place);
    await this.send(answer);
  }

  /** @param {service.ChallengeAnswer} answer */
  async send(answer) {
    const turn = this.turn;
    this.sending = true;
    if (this.main.contains(this.card)) this.question.draw();
    try {
      const solution = await post(this.path('/answer'), answer);
      if (turn !== this.turn) return;
      this.solution = solution;
      markPlayed(this.name, this.solution?.score.total ?? 0);
    } catch (error) {
      if (turn !== this.turn) return;
      this.problem = error;
      this.place.answer = null;
      keepPlace(this.place);
    } finally {
      this.sending = false;
    }
    this.show();
    if (this.solution) query('#result-title').focus({preventScroll: true});
  }

  /** The mystery among others: its seed, and its set-up where that was chosen. */
  get name() {
    return this.setup ? `${this.seed} ${this.setup}` : this.seed;
  }

  /** @param {string} end */
  path(end) {
    const query = this.setup ? `?setup=${encodeURIComponent(this.setup)}` : '';
    return `/api/mysteries/${encodeURIComponent(this.seed)}${end}${query}`;
  }

  /** Draw another mystery. @param {string} [setup] @returns {Promise<void>} */
  another(setup = this.setup) {
    history.pushState(null, '', addressOf(anySeed(), setup));
    return this.open();
  }

  again() {
    keepPlace(fresh(this.name));
    return this.open();
  }
}
