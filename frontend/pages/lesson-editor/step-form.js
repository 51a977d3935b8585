// The words and questions of a step, what it shows, and when an answer is right.

import {fill, h} from '../../common/dom.js';
import {nameOf} from '../../widgets/played-strips.js';
import {adding, byName, choice, removal, row, words} from './inputs.js';
import {conditionRows, measureRows} from './measures.js';
import {t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */
/** @import {DraftAnswer, DraftSaw, DraftStep} from './draft.js' */
/** @import {Form} from './inputs.js' */
/** @import {Known} from './measures.js' */

/**
 * @param {HTMLElement} root
 * @param {Form} form
 * @param {DraftStep} step
 * @param {Known & {strips: string[], sites: string[]}} known
 */
export function drawStep(root, form, step, known) {
  const change = (/** @type {() => void} */ act) => () => {
    act();
    form.changed();
    form.rebuild();
  };
  step.show ??= {strips: []};
  const why = (step.why ??= []);
  const asks = (step.answers?.length ?? 0) > 0;
  fill(
    root,
    row(t('page.editor.title'), words(form, step, 'title', t('page.editor.title'))),
    row(
      t('page.editor.say'),
      step.say.map((_, at) => words(form, step.say, at, t('page.editor.say'), true)),
      step.say.length < 4 &&
        adding(
          t('page.editor.add.paragraph'),
          change(() => step.say.push({en: '', zh: ''})),
        ),
    ),
    row(t('page.editor.show'), shows(form, step, known)),
    row(t('page.editor.ask'), words(form, step, 'ask', t('page.editor.ask'), true)),
    row(t('page.editor.measures'), measureRows(form, step, known)),
    row(
      t('page.editor.answers'),
      (step.answers ?? []).map((answer, at) => answerRow(form, step, answer, at, known)),
      !step.choices?.length &&
        !step.dial &&
        !step.sketch &&
        h(
          'div',
          {class: 'editor-adds'},
          adding(
            t('page.editor.add.answer'),
            change(() => (step.answers ??= []).push(newAnswer(step, null))),
          ),
          known.sites.length > 1 &&
            !asks &&
            adding(
              t('page.editor.add.places'),
              change(() => {
                step.answers = known.sites.slice(0, 8).map((site) => newAnswer(step, site));
                step.show.picture = 'plant';
              }),
            ),
          !asks &&
            step.show.strips.length > 0 &&
            adding(
              t('page.editor.add.sketch'),
              change(() => {
                const strip = step.show.strips[0];
                step.sketch = {strip, low: -1, high: 1, value: 0, solution: [0, 0, 0, 0, 0, 0, 0]};
                step.right_if ??= [];
              }),
            ),
        ),
    ),
    (step.choices?.length || step.dial || step.sketch) &&
      row(
        t('page.editor.right-if'),
        kindWords(step),
        conditionRows(form, step, (step.right_if ??= [])),
        truthLine('met'),
      ),
    step.sketch &&
      row(
        t('page.editor.sketch'),
        sketchFields(form, step, step.sketch),
        adding(
          t('page.editor.without-sketch'),
          change(() => {
            step.sketch = null;
            step.right_if = [];
          }),
        ),
      ),
    row(t('page.editor.saw'), sawRows(form, step, change)),
    row(
      t('page.editor.why'),
      why.map((_, at) => words(form, why, at, t('page.editor.why'), true)),
      why.length < 3 &&
        adding(
          t('page.editor.add.paragraph'),
          change(() => why.push({en: '', zh: ''})),
        ),
    ),
    row(t('page.editor.if-wrong'), words(form, step, 'look', t('page.editor.if-wrong'), true)),
  );
}

/** @param {DraftStep} step */
const kindWords = (step) =>
  h(
    'p',
    {class: 'soft'},
    step.dial ? t('page.editor.of-dial') : step.sketch ? t('page.editor.of-sketch') : t('page.editor.of-choices'),
  );

/** @param {DraftStep} step @param {string | null} site @returns {DraftAnswer} */
function newAnswer(step, site) {
  step.measures ??= {};
  const [name] = Object.keys(step.measures);
  return {
    text: {en: site ?? '', zh: ''},
    ...(site ? {site} : {}),
    right_if: name ? [{measure: name, at_least: 0}] : [],
  };
}

/** Whether it is true in the recording, and since when: filled in when the step was played. @param {string} of */
const truthLine = (of) => h('p', {class: 'soft truth-line', 'data-truth': of});

/**
 * @param {Form} form
 * @param {DraftStep} step
 * @param {DraftAnswer} answer
 * @param {number} at
 * @param {{sites: string[]}} known
 */
function answerRow(form, step, answer, at, known) {
  return h(
    'div',
    {class: 'editor-answer'},
    h(
      'div',
      {class: 'answer-words'},
      h('b', {'aria-hidden': 'true'}, String.fromCharCode(65 + at)),
      words(form, answer, 'text', t('page.editor.answer', {n: at + 1})),
      answer.site &&
        choice(t('page.editor.place'), byName(known.sites), answer.site, (site) => {
          answer.site = site;
          form.changed();
        }),
      removal(String.fromCharCode(65 + at), () => {
        step.answers?.splice(at, 1);
        form.changed();
        form.rebuild();
      }),
    ),
    h(
      'div',
      {class: 'right-if'},
      h('span', {class: 'soft'}, t('page.editor.right-if')),
      conditionRows(form, step, answer.right_if),
      Object.keys(step.measures ?? {}).length === 0 && h('span', {class: 'soft'}, t('page.editor.measure-first')),
    ),
    truthLine(String(at)),
  );
}

/**
 * The picture, and the strips.
 * @param {Form} form
 * @param {DraftStep} step
 * @param {{strips: string[]}} known
 */
function shows(form, step, {strips}) {
  const {show} = step;
  show.strips ??= [];
  const picture = show.picture ?? 'plant';
  /** @param {string} name @param {'truth' | 'diagnosis'} key @param {boolean} usual */
  const tick = (name, key, usual) =>
    h(
      'label',
      {class: 'chip'},
      h('input', {
        type: 'checkbox',
        checked: show[key] ?? usual,
        onchange: (/** @type {Event} */ event) => {
          show[key] = /** @type {HTMLInputElement} */ (event.target).checked;
          form.changed();
        },
      }),
      name,
    );
  return [
    choice(
      t('page.editor.picture'),
      [
        ['plant', t('page.editor.picture.plant')],
        ['none', t('page.editor.picture.none')],
        ...(picture === 'copy' || picture === 'hysteresis' ? [/** @type {const} */ ([picture, picture])] : []),
      ],
      picture,
      (value) => {
        show.picture = value;
        form.changed();
      },
    ),
    h(
      'div',
      {class: 'chips'},
      tick(t('page.editor.truth'), 'truth', true),
      tick(t('page.editor.diagnosis'), 'diagnosis', false),
    ),
    h(
      'div',
      {class: 'chips', role: 'group', 'aria-label': t('page.editor.strips')},
      [...new Set([...strips, ...show.strips])].map((name) =>
        h(
          'label',
          {class: 'chip'},
          h('input', {
            type: 'checkbox',
            value: name,
            checked: show.strips.includes(name),
            onchange: (/** @type {Event} */ event) => {
              const {checked} = /** @type {HTMLInputElement} */ (event.target);
              show.strips = checked ? [...show.strips, name].slice(-4) : show.strips.filter((one) => one !== name);
              form.changed();
              form.rebuild();
            },
          }),
          nameOf(name),
        ),
      ),
    ),
  ];
}

/**
 * Limits and a right curve of a sketch, as numbers.
 * @param {Form} form
 * @param {DraftStep} step
 * @param {service.SketchInput} sketch
 */
function sketchFields(form, step, sketch) {
  /** @param {string} name @param {'low' | 'high'} key */
  const number = (name, key) => h('label', {}, name, ' ', numberOf(form, sketch, key, name));
  return [
    choice(
      t('page.editor.strips'),
      step.show.strips.map((one) => /** @type {[string, string]} */ ([one, nameOf(one)])),
      sketch.strip,
      (value) => {
        sketch.strip = value;
        form.changed();
      },
    ),
    number(t('page.editor.sketch.low'), 'low'),
    number(t('page.editor.sketch.high'), 'high'),
    h(
      'div',
      {class: 'chips'},
      h('span', {class: 'soft'}, t('page.editor.sketch.solution')),
      sketch.solution.map((_, at) =>
        numberOf(form, sketch.solution, at, `${t('page.editor.sketch.solution')} ${at + 1}`),
      ),
    ),
  ];
}

/**
 * @template {PropertyKey} K
 * @param {Form} form
 * @param {{[key in K]?: number}} owner
 * @param {K} key
 * @param {string} name
 */
function numberOf(form, owner, key, name) {
  /** @type {HTMLInputElement} */
  const field = h('input', {
    type: 'number',
    step: 'any',
    class: 'numeral',
    'aria-label': name,
    oninput: () => {
      owner[key] = Number.isNaN(field.valueAsNumber) ? 0 : field.valueAsNumber;
      form.changed();
    },
  });
  field.value = String(owner[key] ?? 0);
  return field;
}

/** @param {Form} form @param {DraftStep} step @param {(act: () => void) => () => void} change */
function sawRows(form, step, change) {
  /** @type {DraftSaw[]} */
  const all = (step.saw ??= []);
  return [
    all.map((saw, at) => [
      h(
        'div',
        {class: 'answer-words'},
        words(form, saw, 'text', t('page.editor.saw'), true),
        removal(
          t('page.editor.saw'),
          change(() => all.splice(at, 1)),
        ),
      ),
      saw.when && saw.when.length > 0 && conditionRows(form, step, saw.when),
    ]),
    h('p', {class: 'soft'}, t('page.editor.saw.hint')),
    all.length < 4 &&
      adding(
        t('page.editor.add.sentence'),
        change(() => all.push({text: {en: '', zh: ''}})),
      ),
  ];
}
