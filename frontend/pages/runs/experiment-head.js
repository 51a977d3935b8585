// The chosen experiment: its description, its form, the run and its progress.

import {fill, h} from '../../common/dom.js';
import {formField, stale} from './run-state.js';
import {createForm} from './override-form.js';
import {problemBlock} from '../../common/problem.js';
import {timeline} from './fault-bars.js';
import {sentences} from '../../widgets/truth-differences.js';
import {named, t} from '../../i18n/words.js';

/** @import {RunActions, RunState, RunStore} from '../types.js' */

/**
 * @param {HTMLElement} root
 * @param {RunStore} store
 * @param {RunActions} act
 */
export function mountHead(root, store, act) {
  const about = h('div', {class: 'about'});
  const plan = h('div');
  const reality = h('div', {class: 'reality soft'});
  const form = createForm(store, act);
  const bar = h('progress', {max: 1, value: 0, 'aria-label': t('page.runs.running')});
  const status = h('p', {class: 'status', role: 'status'});
  const cancel = h(
    'button',
    {type: 'button', class: 'quiet', onclick: act.cancel, hidden: true},
    t('page.action.cancel'),
  );
  const start = h('button', {type: 'submit', class: 'run', form: 'form'}, t('page.runs.run'));
  const trouble = h('div');
  const controls = h('div', {class: 'controls'}, start, cancel, status);
  fill(root, about, plan, reality, form.element, trouble, controls, bar);
  root.hidden = true;

  /** @type {(keyof RunState)[]} the fields that the description depends on */
  const SHOWN = ['spec', 'plant', 'chosen', 'foreign'];

  /** @param {RunState} state */
  function showSpec({spec, plant, chosen, phase, foreign}) {
    root.hidden = !spec && !chosen && phase !== 'failed';
    root.classList.toggle('waiting', !spec && phase !== 'failed');
    form.element.hidden = !spec || foreign;
    start.hidden = !spec || foreign;
    if (!spec) {
      fill(plan);
      return fill(about, phase === 'failed' ? null : h('p', {class: 'soft'}, t('page.text.loading')));
    }
    const observers = spec.observers.length
      ? t('page.runs.observers', {n: spec.observers.length})
      : t('page.runs.no-observers');
    fill(
      about,
      h('h1', {}, named(spec.title) || spec.id),
      spec.source && h('p', {class: 'soft'}, named(spec.source)),
      spec.description && h('p', {}, named(spec.description)),
    );
    fill(
      plan,
      timeline(spec, plant),
      h('p', {class: 'soft'}, t('page.runs.plan', {horizon: spec.horizon, step: spec.step, observers})),
    );
    return form.build();
  }

  /**
   * How the simulated plant differs from the model: that of the run that is shown, else that of the experiment.
   * @param {RunState} state
   */
  function showReality({spec, run, plant}) {
    const shown = run?.spec ?? spec;
    fill(reality, shown && sentences(shown, plant).map((one) => h('p', {}, one)));
  }

  /** @param {RunState} state */
  function showProgress(state) {
    const {phase, progress, problem, spec} = state;
    const running = phase === 'running';
    root.setAttribute('aria-busy', String(running));
    bar.classList.toggle('on', running);
    if (progress.status === 'running') bar.value = progress.progress;
    else bar.removeAttribute('value');
    cancel.hidden = !running || !progress.links.cancel;
    start.disabled = running || !spec;
    fill(start, state.run ? t('page.runs.run-again') : t('page.runs.run'));
    fill(
      status,
      running
        ? progress.status === 'queued'
          ? progress.links.cancel
            ? t('page.runs.queued')
            : t('page.runs.running')
          : t('page.runs.percent', {percent: Math.floor(100 * progress.progress)})
        : phase === 'cancelled'
          ? t('page.runs.cancelled')
          : stale(state)
            ? t('page.runs.stale')
            : '',
    );
    status.classList.toggle('note', !running && stale(state));
    const left =
      problem && spec ? problem.errors.filter((error) => !form.has(formField(spec, error.field))) : problem?.errors;
    fill(trouble, problem && (left?.length || !problem.errors.length) ? problemBlock(problem, left) : null);
  }

  store.subscribe((state, before) => {
    if (SHOWN.some((key) => state[key] !== before[key]) || (state.phase === 'failed' && !state.spec)) showSpec(state);
    if (
      ['spec', 'plant', 'run'].some(
        (key) => state[/** @type {keyof RunState} */ (key)] !== before[/** @type {keyof RunState} */ (key)],
      )
    )
      showReality(state);
    form.update(state, before);
    showProgress(state);
  });
}
