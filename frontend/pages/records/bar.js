// The second bar: the file left, the steps in the middle, actions right; at most one of them is black: what to do next.

import {h} from '../../common/dom.js';
import {language, named, say, t} from '../../i18n/words.js';
import {icon} from '../../widgets/svg.js';
import {applyRemedy, remedies, remedyWords} from './fit/suspects.js';
import {span} from './numbers.js';

/** @import {RecordActions, RecordState, Step} from './types.js' */
/** @import {Child} from '../../types/dom.js' */

/**
 * The content of the bar.
 * @param {RecordState} state
 * @param {RecordActions} act
 * @param {{copyLink: () => void, exportFindings: (format: 'json' | 'csv') => void}} more
 */
export function bar(state, act, more) {
  return [
    h('div', {class: 'record-name'}, h('h1', {}, state.inspection?.name || t('page.records.title')), subtitle(state)),
    steps(state, act),
    h('div', {class: 'bar-actions'}, state.work ? working(state, act) : actions(state, act, more)),
  ];
}

/** @param {RecordState} state */
function subtitle({inspection, plant, step, remark}) {
  if (!inspection) return null;
  const {rows, times, dialect} = inspection;
  const facts = [
    t('page.records.rows', {n: rows}),
    times && span(times.duration),
    step === 1 ? say(dialect) : named(plant?.title) || plant?.id,
  ];
  return h(
    'small',
    {},
    remark ? `${facts.filter(Boolean).join(' · ')} · ${remark()}` : facts.filter(Boolean).join(' · '),
  );
}

/** @param {RecordState} state @param {RecordActions} act */
function steps({step, inspection, diagnosis, stale}, act) {
  const fits = diagnosis !== null && diagnosis.fit.verdict !== 'does-not-fit';
  const reached = [inspection !== null, diagnosis !== null, fits && !stale];
  /** @param {Step} one */
  const item = (one) => {
    const done = one < step || (reached[one] ?? false);
    const open = reached[one - 1] && one !== step;
    const words = one === 2 && step !== 2 && fits ? t('page.records.step.fits') : t(`page.records.step.${one}`);
    return h(
      'li',
      {class: one === step ? 'present' : done ? 'done' : ''},
      h(
        'button',
        {
          type: 'button',
          id: `step-${one}`,
          disabled: !open && one !== step,
          'aria-label': words,
          'aria-current': one === step ? 'step' : null,
          onclick: () => open && act.go(one),
        },
        h('span', {class: 'sign', 'aria-hidden': 'true'}, done && one !== step ? '✓' : one),
        h('span', {class: 'words'}, words),
      ),
    );
  };
  return h(
    'nav',
    {class: 'steps', 'aria-label': t('page.records.steps-label')},
    h('ol', {}, item(1), item(2), item(3)),
  );
}

/** @param {RecordState} state @param {RecordActions} act @returns {Child} */
function working({work}, act) {
  return [
    h('span', {class: 'working', role: 'status'}, t(`page.records.work.${work}`)),
    h('span', {class: 'elapsed', 'aria-hidden': 'true'}),
    h('button', {type: 'button', class: 'quiet', id: 'cancel', onclick: () => act.cancel()}, t('page.records.cancel')),
  ];
}

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 * @param {Parameters<typeof bar>[2]} more
 * @returns {Child}
 */
function actions(state, act, more) {
  const {step, inspection} = state;
  if (!inspection) return null;
  const back = h(
    'button',
    {type: 'button', class: 'quiet', onclick: () => act.go(/** @type {Step} */ (step - 1))},
    t('page.records.back'),
  );
  if (step === 1)
    return [
      h('button', {type: 'button', class: 'quiet', onclick: () => act.startOver()}, t('page.records.other-file')),
      main(t('page.records.step.2'), () => act.diagnose(), {off: !inspection.ready, why: notReady(state)}),
    ];
  if (step === 2) return [back, fitActions(state, act)];
  const [run] = state.runs;
  return [
    back,
    run &&
      h(
        'a',
        {
          class: 'quiet',
          id: 'report',
          href: `${run.links.report}?lang=${language()}`,
          target: '_blank',
          rel: 'noopener',
        },
        t('page.records.report'),
      ),
    downloads(state, more),
    h(
      'button',
      {type: 'button', class: 'quiet', id: 'copy-link', onclick: more.copyLink},
      icon('link'),
      t('page.records.link'),
    ),
    run
      ? main(t('page.records.replay'), () => act.replay())
      : main(t('page.records.observers.run'), () => act.runObservers()),
  ];
}

/**
 * Everything that can be downloaded: the findings, and the columns of the run.
 * @param {RecordState} state
 * @param {Parameters<typeof bar>[2]} more
 */
function downloads({runs: [run]}, more) {
  /** @param {'csv' | 'json'} format */
  const findings = (format) =>
    h(
      'button',
      {type: 'button', onclick: () => more.exportFindings(format)},
      t('page.records.download.findings', {format: format.toUpperCase()}),
    );
  /** @param {string} format @param {string} words */
  const data = (format, words) =>
    run &&
    h(
      'a',
      {href: `${run.links.data}?format=${format}`, download: ''},
      t('page.records.download.columns', {format: words}),
    );
  return h(
    'details',
    {class: 'download', id: 'download'},
    h('summary', {class: 'quiet'}, icon('export'), t('page.records.download')),
    h(
      'div',
      {class: 'download-list'},
      findings('csv'),
      findings('json'),
      data('csv', 'CSV'),
      data('mat', 'MATLAB'),
      data('parquet', 'Parquet'),
    ),
  );
}

/** @param {RecordState} state @param {RecordActions} act */
function fitActions(state, act) {
  const {diagnosis, stale} = state;
  if (!diagnosis || stale)
    return main(diagnosis ? t('page.records.check-again') : t('page.records.step.2'), () => act.diagnose());
  if (diagnosis.fit.verdict !== 'does-not-fit')
    return main(
      diagnosis.fit.verdict === 'fits-after-fit' ? t('page.records.find-faults-fitted') : t('page.records.find-faults'),
      () => act.go(3),
    );
  const remedy = remedies(state, diagnosis).find((one) => one !== null) ?? null;
  const faded = h(
    'button',
    {type: 'button', class: 'quiet', 'aria-disabled': 'true', title: t('page.records.why-none.text')},
    t('page.records.find-faults'),
  );
  return [faded, remedy && main(remedyWords(remedy), () => applyRemedy(remedy, act))];
}

/** @param {RecordState} state */
function notReady({inspection, choice}) {
  if (choice === null) return t('page.records.choose-plant');
  return inspection?.problem ? say(inspection.problem) : '';
}

/**
 * The black button. Off, it stays focusable and leads to the reason.
 * @param {string} words
 * @param {() => void} act
 * @param {{off?: boolean, why?: string}} [state]
 */
const main = (words, act, {off = false, why = ''} = {}) =>
  h(
    'button',
    {
      type: 'button',
      class: 'run next',
      id: 'next',
      'aria-disabled': off ? 'true' : null,
      title: off ? why : null,
      onclick: off ? () => document.querySelector('#plant.wanted, #found')?.scrollIntoView({block: 'center'}) : act,
    },
    words,
  );
