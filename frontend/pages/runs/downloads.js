// Data, report and specification of the run, and the command that repeats it.

import {asTyped} from './address.js';
import {h, number} from '../../common/dom.js';
import {pack} from '../../live/state/permalink.js';
import {language, t} from '../../i18n/words.js';

/** @import {Properties} from '../../types/dom.js' */
/** @import {Changes, Run, RunState} from '../types.js' */

/** @param {Pick<RunState, 'chosen' | 'foreign' | 'ranWith'> & {run: Run}} state */
export function downloads({run, chosen, foreign, ranWith}) {
  /**
   * @param {string} title
   * @param {string} href
   * @param {Properties} [more]
   */
  const link = (title, href, more = {}) => h('a', {class: 'quiet', href, ...more}, title);
  /** @param {string} format */
  const data = (format) => `${run.links.data}?format=${format}`;
  const spec = URL.createObjectURL(new Blob([JSON.stringify(run.spec, null, 1)], {type: 'application/json'}));
  const seconds = Object.values(run.summary?.seconds ?? {}).reduce((sum, one) => sum + one, 0);
  return [
    run.warning && h('p', {class: 'alarm small', role: 'status'}, run.warning),
    h(
      'p',
      {class: 'links'},
      h(
        'button',
        {type: 'button', class: 'quiet', title: t('page.runs.open-live.hint'), onclick: () => openLive(run)},
        t('page.runs.open-live'),
      ),
      !run.spec.truth.record &&
        link(t('page.studies.of-run'), `/studies/?run=${encodeURIComponent(run.id)}`, {
          title: t('page.studies.of-run.hint'),
        }),
      link('CSV', data('csv'), {download: ''}),
      link('MATLAB .mat', data('mat'), {download: ''}),
      link('JSON', data('json'), {download: ''}),
      link(t('page.export.report'), `${run.links.report}?lang=${language()}`, {
        title: t('page.export.report.hint'),
        target: '_blank',
        rel: 'noopener',
      }),
      run.summary?.comparison &&
        link(t('page.comparison.title'), `${run.links.comparison}?format=csv`, {
          download: '',
          title: t('page.runs.comparison.hint'),
        }),
      link(t('page.export.notebook'), `${run.links.self}/notebook`, {
        download: '',
        title: t('page.export.notebook.hint'),
      }),
      link(t('page.export.spec'), spec, {download: `${run.spec.id}.json`, title: t('page.export.spec.hint')}),
    ),
    !foreign && chosen !== null && command(chosen, JSON.parse(ranWith ?? '{}')),
    h(
      'p',
      {class: 'soft small'},
      `${t('page.runs.id')} `,
      h('code', {}, run.id.slice(0, 12)),
      seconds ? t('page.runs.took', {seconds: number(seconds, 2)}) : '',
    ),
  ];
}

/**
 * Open a session that has done all of a run, and is paused at its end; the record of one is replayed from its start.
 * @param {Run} run
 */
async function openLive({spec}) {
  location.assign(`/#s=${await pack({spec, t: spec.truth.record ? 0 : spec.horizon})}`);
}

/** @param {string} word */
const quoted = (word) => (/^[\w.,:=+-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`);

/** @param {string} chosen @param {Changes} changes */
function command(chosen, changes) {
  const words = [
    'thetascope run',
    quoted(chosen),
    ...Object.entries(changes).map(([path, to]) => `--set ${quoted(`${path}=${asTyped(to)}`)}`),
    '--out run.csv',
  ];
  const line = h('code', {}, words.join(' '));
  const copy = h(
    'button',
    {
      type: 'button',
      class: 'quiet',
      onclick: async () => {
        await navigator.clipboard.writeText(line.textContent);
        copy.textContent = t('page.action.copied');
        setTimeout(() => {
          copy.textContent = t('page.action.copy');
        }, 1500);
      },
    },
    t('page.action.copy'),
  );
  return [h('p', {class: 'soft small'}, t('page.runs.command')), h('div', {class: 'command'}, line, copy)];
}
