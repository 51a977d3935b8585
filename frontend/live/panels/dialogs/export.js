// Downloads: data and report of this session as an ordinary run, a picture of the scope, the specification. Only those
// who control a session can save it as a run; viewers get the data as displayed.

import {fill, h} from '../../../common/dom.js';
import {refused} from '../../actions.js';
import {language, t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */
/** @import {Run} from '../../../pages/types.js' */

/** @param {HTMLElement} body @param {App} app */
export function showExport(body, app) {
  const viewing = app.state.role === 'view';
  const note = () => t(viewing ? 'page.export.viewer-note' : 'page.export.note');
  const status = h('p', {class: 'soft', role: 'status'}, note());
  /** @type {Promise<Run> | null} */
  let run = null;
  const saved = async () => {
    status.textContent = t('page.export.saving');
    run ??= app.act.save();
    try {
      return await run;
    } catch (error) {
      run = null;
      throw error;
    }
  };
  /**
   * @param {string} words
   * @param {string} hint
   * @param {() => Promise<void>} act
   */
  const button = (words, hint, act) =>
    h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        title: hint,
        onclick: async (event) => {
          const target = event.currentTarget;
          target.disabled = true;
          try {
            await act();
            status.textContent = note();
          } catch (error) {
            status.textContent = refused(error);
          } finally {
            target.disabled = false;
          }
        },
      },
      words,
    );
  /** @param {string} format */
  const data = (format) => async () => {
    const {session, spec} = app.state;
    if (viewing && session !== null && spec !== null) {
      const address = `/api/sessions/${encodeURIComponent(session)}/data?format=${format}`;
      fetchTo(address, `${spec.id}-${session.slice(0, 8)}.${format}`);
      return;
    }
    const {id, links} = await saved();
    fetchTo(`${links.data}?format=${format}`, `${app.state.spec?.id}-${id.slice(0, 8)}.${format}`);
  };
  /** @param {'png' | 'svg'} format */
  const figure = (format) => async () =>
    download(await app.act.figure({strip: null, format}), `${app.state.spec?.id}.${format}`);
  fill(
    body,
    h('h3', {}, t('page.export.data')),
    h(
      'div',
      {class: 'links'},
      button('CSV', t('page.export.csv.hint'), data('csv')),
      button('MATLAB .mat', t('page.export.mat.hint'), data('mat')),
      button('JSON', t('page.export.json.hint'), data('json')),
    ),
    h('h3', {}, t('page.export.picture')),
    h(
      'div',
      {class: 'links'},
      button('PNG', t('page.export.png.hint'), figure('png')),
      button('SVG', t('page.export.svg.hint'), figure('svg')),
    ),
    ...(viewing ? [] : asRun(saved, button, app)),
    status,
  );
}

/**
 * The downloads that need the session as a run.
 * @param {() => Promise<Run>} saved
 * @param {(words: string, hint: string, act: () => Promise<void>) => HTMLElement} button
 * @param {App} app
 */
const asRun = (saved, button, app) => [
  h('h3', {}, t('page.export.run')),
  h(
    'div',
    {class: 'links'},
    button(t('page.export.report'), t('page.export.report.hint'), async () => {
      const {links} = await saved();
      fetchTo(`${links.report}?download=1&lang=${language()}`, `${app.state.spec?.id}.html`);
    }),
    button(t('page.export.spec'), t('page.export.spec.hint'), async () => {
      const {spec, id} = await saved();
      download(
        new Blob([JSON.stringify(spec, null, 2)], {type: 'application/json'}),
        `${spec.id}-${id.slice(0, 8)}.json`,
      );
    }),
    button(t('page.export.open-run'), t('page.export.open-run.hint'), async () => {
      const {id} = await saved();
      open(`/runs/?run=${id}`, '_blank', 'noopener');
    }),
  ),
];

/** @param {string} address @param {string} name */
function fetchTo(address, name) {
  const link = h('a', {href: address, download: name});
  document.body.append(link);
  link.click();
  link.remove();
}

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const address = URL.createObjectURL(blob);
  fetchTo(address, name);
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
