// Make a lesson without code: a recording from Live, words and questions, a preview that plays it.

import {connection, get, post, Problem, reason} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {mountTop} from '../../common/page-header.js';
import {chosenLanguage} from '../../i18n/language.js';
import {language, named, speak, t} from '../../i18n/words.js';
import {drawBar} from './bar.js';
import {emptyLesson, finished, keepDraft, keptDraft, newStep} from './draft.js';
import {removal, row, words} from './inputs.js';
import {Preview} from './preview.js';
import {drawRecording} from './recording.js';
import {drawStep} from './step-form.js';

/** @import * as service from '../../types/service.js' */
/** @import {DraftLesson} from './draft.js' */

const PAUSE = 700; // ms after the last change before the step is played
const asked = new URLSearchParams(location.search);

export class Editor {
  constructor() {
    /** @type {DraftLesson} */
    this.lesson = emptyLesson('');
    this.place = 0;
    /** @type {'en' | 'zh'} */
    this.language = language() === 'zh' ? 'zh' : 'en';
    /** @type {service.Played | null} */
    this.played = null;
    /** @type {Map<string, service.Played>} */
    this.recordings = new Map();
    this.problem = '';
    this.status = '';
    this.turn = 0;
    this.timer = 0;
    this.bar = h('section', {class: 'editor-bar', 'aria-label': t('page.editor.page-title')});
    this.left = h('section', {class: 'card'});
    this.steps = h('section', {class: 'editor-steps'});
    this.centre = h('section', {class: 'card editor-words'});
    this.form = h('div', {});
    this.right = h('section', {class: 'editor-preview card'});
    this.preview = new Preview(this.right);
  }

  /** @returns {import('./draft.js').DraftStep | undefined} */
  get step() {
    return this.lesson.steps[this.place];
  }

  /** What was recorded for the step. @returns {service.ExperimentInput | undefined} */
  get spec() {
    const name = this.step?.start?.experiment;
    return name === undefined ? undefined : this.lesson.experiments[name];
  }

  /** Load what the address asks for, or go on with the draft of this browser. */
  async begin() {
    const [id, session] = [asked.get('lesson'), asked.get('session')];
    const kept = keptDraft();
    try {
      if (id) await this.open(id);
      else if (session) await this.record(session, kept);
      else if (kept) this.lesson = kept;
    } catch (error) {
      this.status = reason(error).message;
    }
    if (id || session) history.replaceState(null, '', '/lesson-editor/');
    this.changed();
    this.draw();
  }

  /** @param {string} id   of a saved lesson; one of the library is copied */
  async open(id) {
    const lesson = /** @type {DraftLesson} */ (await get(`/api/course/${encodeURIComponent(id)}`));
    const own = /** @type {service.MyLessonList} */ (await get('/api/my-lessons')).lessons.some(
      (one) => one.id === id && one.mine,
    );
    this.savedId = own ? id : '';
    this.lesson = own ? lesson : {...lesson, id: `my-${id}`.slice(0, 60)};
  }

  /**
   * A session of Live becomes a recording of the lesson, and its last half minute a step.
   * @param {string} session
   * @param {DraftLesson | null} kept
   */
  async record(session, kept) {
    const state = /** @type {service.SessionState} */ (await get(`/api/sessions/${encodeURIComponent(session)}`));
    const {spec} = state;
    this.lesson = kept ?? emptyLesson(named(spec.title));
    const names = Object.keys(this.lesson.experiments);
    const name = `recording-${names.length + 1}`;
    const until = Math.max(1, Math.floor(state.t));
    this.lesson.experiments[name] = {...spec, horizon: Math.max(spec.horizon, until)};
    const happened = spec.faults.map((one) => one.onset).filter((one) => one < until);
    const first = happened.length ? Math.max(0, Math.floor(Math.max(...happened)) - 5) : Math.max(0, until - 30);
    const step = newStep(name, first, until);
    this.lesson.steps.push(step);
    this.place = this.lesson.steps.length - 1;
    const shown = this.known().strips;
    step.show.strips = [...shown.filter((one) => one.startsWith('residual.')), ...shown].slice(0, 1);
  }

  /** What the session of the step has: columns, channels, observers. */
  known() {
    const {spec} = this;
    const plant = typeof spec?.plant === 'object' ? spec.plant : null;
    const named = (/** @type {{name: string}[] | undefined} */ all) => (all ?? []).map(({name}) => name);
    const columns = this.played?.columns ?? [];
    const observers = (spec?.observers ?? []).map(({label, gains = {}}) => ({label, gains: Object.keys(gains)}));
    const channels = plant ? named(plant.channels) : columnsOf(columns, 'theta.');
    const outputs = plant ? named(plant.outputs) : columnsOf(columns, 'y.');
    const states = plant ? named(plant.states) : columnsOf(columns, 'x.');
    const strips = [
      ...(observers.length ? outputs.map((one) => `residual.${one}`) : []),
      ...states.map((one) => `x.${one}`),
      ...channels.map((one) => `theta.${one}`),
      ...(plant ? named(plant.inputs) : columnsOf(columns, 'u.')).map((one) => `u.${one}`),
    ];
    const measurable = columns.filter((one) => one !== 't');
    return {
      columns: this.step?.sketch ? [...measurable, 'sketch'] : measurable,
      channels,
      observers,
      strips,
      sites: [...channels, ...outputs],
    };
  }

  /** Keep a change, and play the step soon. */
  changed = () => {
    keepDraft(this.lesson);
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.play(), PAUSE);
    this.drawBar();
  };

  whole() {
    return finished(this.lesson, t('page.editor.untitled'));
  }

  async play() {
    const turn = (this.turn += 1);
    if (!this.step) return;
    const lesson = this.whole();
    const place = this.place;
    let played = null;
    let problem = '';
    const first = this.played === null;
    try {
      played = /** @type {service.Played} */ (await post('/api/course/play', {lesson, step: place}));
    } catch (error) {
      problem = asProblem(error);
    }
    if (turn !== this.turn) return;
    this.played = played ?? this.played;
    this.problem = problem;
    this.preview.show(lesson, place, played, problem);
    this.showTruth(played);
    if (first && played) this.drawForm();
    await this.recordWhole(lesson);
  }

  /** The whole recording, for its strip. @param {service.CourseLessonInput} lesson */
  async recordWhole(lesson) {
    const {spec, step} = this;
    const name = step?.start?.experiment;
    const strip = step?.show?.strips?.[0];
    const key = `${name} ${strip}`;
    if (!spec || !strip || this.recordings.has(key)) return;
    const same = this.lesson.steps.filter((one) => one.start?.experiment === name);
    const last = Math.max(...same.map(({start, run}) => (start?.t ?? 0) + (run?.seconds ?? 0)), 1);
    const title = lesson.title;
    const whole = {title, say: [title], start: {experiment: name, t: 0}, run: {seconds: last}, show: {strips: [strip]}};
    try {
      const played = await post('/api/course/play', {lesson: {...lesson, steps: [whole]}, step: 0});
      this.recordings.set(key, /** @type {service.Played} */ (played));
      this.drawRecord();
    } catch {
      /* the problem of the step says what is wrong */
    }
  }

  /**
   * Whether each answer is right in the recording, and since when; and the numbers.
   * @param {service.Played | null} played
   */
  showTruth(played) {
    const deed = played?.deeds[0];
    for (const line of this.form.querySelectorAll('.truth-line')) {
      const of = line.getAttribute('data-truth') ?? '';
      const met = of === 'met' ? played?.deeds.find(({judged}) => judged.met) : undefined;
      const since = of === 'met' ? met?.met_since : deed?.since[Number(of)];
      line.textContent = !deed
        ? ''
        : typeof since === 'number'
          ? t('page.editor.true-since', {t: Number(since.toPrecision(3))})
          : t('page.editor.false');
      line.classList.toggle('ok', typeof since === 'number');
    }
    for (const output of this.form.querySelectorAll('[data-measure]')) {
      const value = deed?.judged.values[output.getAttribute('data-measure') ?? ''];
      output.textContent = deed ? `= ${typeof value === 'number' ? Number(value.toPrecision(3)) : '–'}` : '';
    }
  }

  draw() {
    document.title = t('page.editor.page-title');
    fill(query('.skip'), t('page.nav.skip-to-lessons'));
    fill(
      query('#main'),
      this.bar,
      h(
        'div',
        {class: 'editor-columns'},
        h('div', {class: 'editor-left'}, this.left, this.steps),
        this.centre,
        this.right,
      ),
    );
    this.drawBar();
    this.rebuild();
  }

  rebuild = () => {
    this.drawRecord();
    this.drawSteps();
    this.drawForm();
    if (this.step) this.preview.show(this.whole(), this.place, this.played, this.problem);
    else fill(this.right, h('h2', {}, t('page.editor.preview')));
  };

  drawRecord() {
    const key = `${this.step?.start?.experiment} ${this.step?.show?.strips?.[0]}`;
    drawRecording(this.left, {
      lesson: this.lesson,
      step: this.step,
      whole: this.recordings.get(key) ?? null,
      changed: this.changed,
      rebuild: this.rebuild,
    });
  }

  drawSteps() {
    const {steps} = this.lesson;
    /** @param {number} place @param {number} by */
    const move = (place, by) => {
      const [one] = steps.splice(place, 1);
      steps.splice(place + by, 0, one);
      this.go(place + by);
    };
    /** @param {string} shown @param {string} name @param {boolean} off @param {() => void} act */
    const small = (shown, name, off, act) =>
      h(
        'button',
        {type: 'button', class: 'quiet', 'aria-label': name, title: name, disabled: off, onclick: act},
        shown,
      );
    fill(
      this.steps,
      h('h2', {}, t('page.editor.steps')),
      h(
        'ol',
        {},
        steps.map((step, place) => {
          const title = named(step.title) || t('page.editor.untitled');
          return h(
            'li',
            {},
            h(
              'button',
              {
                type: 'button',
                class: 'step-name',
                'aria-current': place === this.place ? 'step' : null,
                onclick: () => this.go(place),
              },
              `${place + 1}  ${title}`,
            ),
            small('↑', t('page.editor.up', {title}), place === 0, () => move(place, -1)),
            small('↓', t('page.editor.down', {title}), place === steps.length - 1, () => move(place, 1)),
            removal(title, () => {
              steps.splice(place, 1);
              this.go(Math.max(0, Math.min(this.place, steps.length - 1)));
            }),
          );
        }),
      ),
      this.step &&
        steps.length < 12 &&
        h('button', {type: 'button', class: 'editor-add', onclick: () => this.add()}, `+ ${t('page.editor.add.step')}`),
    );
  }

  /** A step that goes on where this one ends, in the same recording. */
  add() {
    if (!this.step) return;
    const {start, run, show} = this.step;
    const from = (start?.t ?? 0) + (run?.seconds ?? 0);
    const step = newStep(
      start?.experiment ?? Object.keys(this.lesson.experiments)[0],
      from,
      from + (run?.seconds ?? 10),
    );
    Object.assign(step.show, {strips: [...(show?.strips ?? [])]});
    this.lesson.steps.splice(this.place + 1, 0, step);
    this.go(this.place + 1);
  }

  /** @param {number} place */
  go(place) {
    this.place = place;
    this.preview.shown = 'before';
    this.changed();
    this.rebuild();
  }

  drawForm() {
    const {step} = this;
    /** @param {'en' | 'zh'} one @param {string} name */
    const tongue = (one, name) =>
      h(
        'button',
        {
          type: 'button',
          lang: one,
          'aria-pressed': String(this.language === one),
          onclick: () => {
            this.language = one;
            this.drawForm();
          },
        },
        name,
        step && !step.title?.[one] && h('span', {class: 'soft'}, ` · ${t('page.editor.missing')}`),
      );
    const form = {language: this.language, changed: this.changed, rebuild: this.rebuild};
    fill(
      this.centre,
      h(
        'div',
        {class: 'heading'},
        h('h2', {}, t('page.editor.words')),
        h(
          'div',
          {class: 'segments', role: 'group', 'aria-label': t('page.editor.languages')},
          tongue('en', 'English'),
          tongue('zh', '中文'),
        ),
      ),
      h('p', {class: 'soft'}, t('page.editor.words.hint')),
      row(t('page.editor.lesson'), words(form, this.lesson, 'title', t('page.editor.lesson'))),
      row(t('page.editor.outcome'), words(form, this.lesson, 'outcome', t('page.editor.outcome'))),
      this.form,
    );
    if (step) drawStep(this.form, form, step, this.known());
    else fill(this.form);
    this.showTruth(this.played);
  }

  drawBar() {
    drawBar(this);
  }

  savedId = '';
}

/** @param {readonly string[]} columns @param {string} prefix */
const columnsOf = (columns, prefix) =>
  columns.filter((one) => one.startsWith(prefix)).map((one) => one.slice(prefix.length));

/** What is wrong, with its field. @param {unknown} error */
function asProblem(error) {
  if (!(error instanceof Problem) || !error.errors.length) return reason(error).message;
  const [{field, problem}] = error.errors;
  return `${field}: ${problem}`;
}

await speak(chosenLanguage());
const editor = new Editor();
mountTop(query('header'), connection, 'learn', () => editor.draw());
await editor.begin();
