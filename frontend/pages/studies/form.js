// The form of a study: the experiment, what varies, how often, with which faults, and what is measured.

import {post, reason} from '../../common/api.js';
import {fill, h} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';
import {OWN, factsOf, faultsAlone, specOfRun} from './experiment.js';
import {countField, line, refill, saveFile} from './fields.js';
import {factorOf, pathsOf, textOf} from './values.js';

/** @import * as service from '../../types/service.js' */
/** @import {Written} from './values.js' */

/**
 * @typedef {object} Row   a factor as it is written
 * @property {string} path
 * @property {string} text
 */

const GROUPS = /** @type {const} */ (['detection', 'rmse', 'peak', 'settling', 'operations']);
const TOGETHER = /** @type {const} */ (['set', 'alone', 'pairs']);
const DESIGNS = /** @type {const} */ (['grid', 'random', 'latin-hypercube', 'sobol']);

/**
 * @param {HTMLElement} root
 * @param {{experiments: readonly service.ExperimentLine[], kinds: readonly service.ObserverKind[],
 *   own: readonly service.MyPlantLine[]}} known   the library's experiments and observers, and the saved plants
 * @param {(study: service.Study, experiment: string) => Promise<void>} begin
 */
export function createForm(root, {experiments, kinds, own}, begin) {
  const state = {
    experiment: experiments[0].id,
    /** @type {service.Experiment | null} */
    inline: null,
    /** @type {service.Experiment | null} */
    spec: null,
    /** @type {string[]} */
    parameters: [],
    /** @type {service.CasesFactor[]} */
    others: [],
    /** @type {Row[]} */
    rows: [{path: '', text: ''}],
    seeds: 10,
    /** @type {Set<'with' | 'without'>} */
    faults: new Set(/** @type {const} */ (['with', 'without'])),
    together: /** @type {typeof TOGETHER[number]} */ ('set'),
    each: false,
    /** @type {Set<string>} */
    measures: new Set(['detection', 'rmse']),
    design: /** @type {typeof DESIGNS[number]} */ ('grid'),
    points: 64,
    title: '',
    busy: false,
  };
  const size = h('p', {class: 'study-size', role: 'status'});
  const refused = h('p', {class: 'alarm', role: 'alert'});
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @type {AbortController | null} */
  let asked = null;

  const observers = () => state.spec?.observers ?? [];
  const steps = () => (state.spec?.faults ?? []).filter((one) => 'channel' in one && one.shape === 'step');

  /** Get what the experiment and its plant have, for the names to choose from. */
  async function load() {
    const chosen = state.inline ?? state.experiment;
    try {
      const found = await factsOf(chosen);
      if (chosen !== (state.inline ?? state.experiment)) return;
      state.spec = found.spec;
      state.parameters = found.parameters;
      if (typeof chosen === 'string' && chosen.startsWith(OWN)) state.inline = found.spec;
      draw();
    } catch (error) {
      fill(refused, reason(error).message);
    }
  }

  /** The study that the form says. @returns {service.Study} */
  function study() {
    const grid = state.design === 'grid';
    /** @type {service.Study['vary']} */
    const vary = state.rows.flatMap((row) => {
      const factor = row.path ? factorOf(row.path, row.text, grid) : null;
      return factor ? [factor] : [];
    });
    if (state.each) vary.push({kind: 'observers', name: 'observer', labels: observers().map((one) => one.label)});
    if (state.together !== 'set') vary.push(faultsAlone(steps(), state.together === 'pairs'));
    vary.push(...state.others);
    return {
      title: state.title,
      description: '',
      experiment: state.inline ?? state.experiment,
      set: {},
      vary,
      design: state.design,
      points: grid ? null : state.points,
      design_seed: 0,
      seeds: state.seeds,
      faults: state.faults.size === 2 ? 'both' : state.faults.has('without') ? 'without' : 'with',
      measures: GROUPS.filter((name) => state.measures.has(name)),
      numbers: {},
      since: 0,
    };
  }

  function changed() {
    clearTimeout(timer);
    timer = setTimeout(measure, 500);
  }

  async function measure() {
    asked?.abort();
    asked = new AbortController();
    const {signal} = asked;
    fill(size, t('page.studies.measuring'));
    try {
      /** @type {service.StudySize} */
      const found = await post('/api/studies/size', study(), signal);
      const one = found.seconds && found.seconds / Math.max(1, navigator.hardwareConcurrency || 1);
      fill(
        size,
        h('b', {}, t('page.studies.runs', {n: found.runs, points: found.points})),
        ' ',
        one !== null && t('page.studies.time', {seconds: Number(one.toPrecision(2))}),
      );
      fill(refused);
    } catch (error) {
      if (signal.aborted) return;
      fill(size);
      fill(refused, reason(error).message);
    }
  }

  async function start() {
    state.busy = true;
    draw();
    try {
      await begin(study(), state.experiment);
    } catch (error) {
      fill(refused, reason(error).message);
    } finally {
      state.busy = false;
      draw();
    }
  }

  /**
   * @param {string} words @param {boolean} on @param {() => void} turn
   */
  const chip = (words, on, turn) =>
    h(
      'button',
      {
        type: 'button',
        class: 'study-chip',
        'aria-pressed': String(on),
        onclick: () => {
          turn();
          draw();
          changed();
        },
      },
      words,
    );

  /** @template T @param {Set<T>} set @param {T} item */
  function toggle(set, item) {
    if (!set.delete(item)) set.add(item);
  }

  function experimentLine() {
    const chosen = h(
      'select',
      {
        'aria-label': t('page.studies.experiment'),
        onchange: () => {
          state.experiment = chosen.value;
          state.inline = null;
          state.rows = [{path: '', text: ''}];
          state.others = [];
          state.together = 'set';
          state.each = false;
          draw();
          load();
          changed();
        },
      },
      state.inline && h('option', {value: '', selected: true}, named(state.inline.title) || state.inline.id),
      own.map(({id, title}) =>
        h('option', {value: OWN + id, selected: !state.inline && state.experiment === OWN + id}, title || id),
      ),
      experiments.map((one) =>
        h(
          'option',
          {value: one.id, selected: !state.inline && one.id === state.experiment},
          named(one.title) || one.id,
        ),
      ),
    );
    return line(t('page.studies.experiment'), chosen);
  }

  /** @param {Row} row @param {number} place */
  function factorLine(row, place) {
    const path = h('input', {
      list: 'study-paths',
      value: row.path,
      placeholder: t('page.studies.path'),
      'aria-label': t('page.studies.path'),
      spellcheck: 'false',
      oninput: () => {
        row.path = path.value.trim();
        changed();
      },
    });
    const text = h('input', {
      value: row.text,
      placeholder: '0.5 … 16, 8, log',
      'aria-label': t('page.studies.values'),
      spellcheck: 'false',
      oninput: () => {
        row.text = text.value;
        changed();
      },
    });
    const remove = h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        'aria-label': t('page.studies.remove-factor'),
        onclick: () => {
          state.rows.splice(place, 1);
          draw();
          changed();
        },
      },
      '×',
    );
    return h('div', {class: 'study-factor'}, path, text, remove);
  }

  /** @param {number} value @param {string} label @param {(value: number) => void} set */
  const count = (value, label, set) =>
    countField(value, label, (next) => {
      set(next);
      changed();
    });

  function designLine() {
    const chosen = h(
      'select',
      {
        'aria-label': t('page.studies.design'),
        onchange: () => {
          state.design = DESIGNS.find((one) => one === chosen.value) ?? 'grid';
          draw();
          changed();
        },
      },
      DESIGNS.map((one) => h('option', {value: one, selected: one === state.design}, t(`page.studies.design.${one}`))),
    );
    return line(
      t('page.studies.design'),
      chosen,
      state.design !== 'grid' && count(state.points, t('page.studies.points'), (value) => (state.points = value)),
    );
  }

  function faultLine() {
    const chosen = h(
      'select',
      {
        'aria-label': t('page.studies.together'),
        onchange: () => {
          state.together = TOGETHER.find((one) => one === chosen.value) ?? 'set';
          draw();
          changed();
        },
      },
      TOGETHER.map((one) =>
        h('option', {value: one, selected: one === state.together}, t(`page.studies.together.${one}`)),
      ),
    );
    return line(
      t('page.studies.faults'),
      chip(t('page.studies.faults.with'), state.faults.has('with'), () => toggle(state.faults, 'with')),
      chip(t('page.studies.faults.without'), state.faults.has('without'), () => toggle(state.faults, 'without')),
      steps().length > 1 && chosen,
    );
  }

  function draw() {
    refill(
      root,
      h('h2', {class: 'study-caption'}, t('page.studies.form')),
      experimentLine(),
      h('div', {class: 'soft'}, t('page.studies.vary')),
      state.rows.map(factorLine),
      h(
        'datalist',
        {id: 'study-paths'},
        (state.spec ? pathsOf(state.spec, kinds, state.parameters) : []).map((path) => h('option', {value: path})),
      ),
      h(
        'button',
        {
          type: 'button',
          class: 'link',
          onclick: () => {
            state.rows.push({path: '', text: ''});
            draw();
          },
        },
        t('page.studies.add-factor'),
      ),
      h('p', {class: 'soft study-hint'}, t('page.studies.values.hint')),
      designLine(),
      line(
        t('page.studies.seeds'),
        count(state.seeds, t('page.studies.seeds'), (value) => (state.seeds = value)),
      ),
      faultLine(),
      observers().length > 1 &&
        line(
          t('page.studies.observers'),
          chip(t('page.studies.observers.each'), state.each, () => (state.each = !state.each)),
        ),
      line(
        t('page.studies.measured'),
        GROUPS.map((name) =>
          chip(t(`page.studies.measured.${name}`), state.measures.has(name), () => toggle(state.measures, name)),
        ),
      ),
      size,
      refused,
      h(
        'p',
        {class: 'study-actions'},
        h('button', {type: 'button', class: 'run', disabled: state.busy, onclick: start}, t('page.studies.begin')),
        h(
          'button',
          {type: 'button', class: 'quiet', onclick: () => saveFile('study.json', study())},
          t('page.studies.file'),
        ),
      ),
      h('p', {class: 'soft study-hint'}, t('page.studies.same')),
    );
  }

  return {
    /** Show the form in another language. @param {readonly service.ExperimentLine[]} lines */
    translate(lines) {
      experiments = lines;
      fill(size);
      fill(refused);
      draw();
      if (state.rows.some((row) => row.text)) changed();
    },
    /**
     * Begin with an experiment of the library, with that of a run, or the first.
     * @param {string | null} id
     * @param {string | null} run
     */
    async start(id, run) {
      const known = experiments.find((one) => one.id === id);
      if (known) state.experiment = known.id;
      if (run) state.inline = await specOfRun(run);
      draw();
      load();
    },
    /** Show a study that exists. @param {service.Study} study */
    show(study) {
      const {experiment} = study;
      if (typeof experiment === 'string') state.experiment = experiment;
      else if (experiments.some((one) => one.id === experiment.id)) {
        state.experiment = experiment.id;
        state.inline = experiment;
      } else state.inline = experiment;
      /** @type {Written[]} */
      const written = study.vary.filter((one) => one.kind === 'list' || one.kind === 'range');
      state.rows = written.map((one) => ({path: one.path, text: textOf(one)}));
      state.others = study.vary.filter((one) => one.kind === 'cases');
      state.each = study.vary.some((one) => one.kind === 'observers');
      const faults = study.vary.find((one) => one.kind === 'faults');
      state.together = faults ? (faults.kind === 'faults' && faults.pairs ? 'pairs' : 'alone') : 'set';
      state.seeds = study.seeds ?? 1;
      state.faults = new Set(
        study.faults === 'both' ? /** @type {const} */ (['with', 'without']) : [study.faults ?? 'with'],
      );
      state.measures = new Set(study.measures);
      state.design = study.design ?? 'grid';
      state.points = study.points ?? 64;
      state.title = named(study.title);
      draw();
      load();
    },
  };
}
