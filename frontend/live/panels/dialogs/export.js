// Take it with you: data and report of this session as an ordinary run, a picture of the scope, the specification.

import {fill, h} from '../../../common/dom.js';
import {refused} from '../../actions.js';

export function showExport(body, app) {
  const {text} = app;
  const status = h('p', {class: 'soft', role: 'status'}, text.exportNote);
  let run = null;
  const saved = async () => {
    status.textContent = text.saving;
    run ??= app.act.save();
    try {
      return await run;
    } catch (error) {
      run = null;
      throw error;
    }
  };
  const button = (words, hint, act) =>
    h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        title: hint,
        onclick: async (event) => {
          const {target} = event;
          target.disabled = true;
          try {
            await act();
            status.textContent = text.exportNote;
          } catch (error) {
            status.textContent = refused(error, text);
          } finally {
            target.disabled = false;
          }
        },
      },
      words,
    );
  const data = (format) => async () => {
    const {id, links} = await saved();
    fetchTo(`${links.data}?format=${format}`, `${app.state.spec.id}-${id.slice(0, 8)}.${format}`);
  };
  const figure = (format) => async () =>
    download(await app.act.figure({strip: null, format}), `${app.state.spec.id}.${format}`);
  fill(
    body,
    h('h3', {}, text.exportData),
    h(
      'div',
      {class: 'links'},
      button('CSV', text.csvHint, data('csv')),
      button('MATLAB .mat', text.matHint, data('mat')),
      button('JSON', text.jsonHint, data('json')),
    ),
    h('h3', {}, text.exportPicture),
    h('div', {class: 'links'}, button('PNG', text.pngHint, figure('png')), button('SVG', text.svgHint, figure('svg'))),
    h('h3', {}, text.exportReport),
    h(
      'div',
      {class: 'links'},
      button(text.report, text.reportHint, async () => {
        const {links} = await saved();
        fetchTo(`${links.report}?download=1`, `${app.state.spec.id}.html`);
      }),
      button(text.spec, text.specHint, async () => {
        const {spec, id} = await saved();
        download(
          new Blob([JSON.stringify(spec, null, 2)], {type: 'application/json'}),
          `${spec.id}-${id.slice(0, 8)}.json`,
        );
      }),
      button(text.openRun, text.openRunHint, async () => {
        const {id} = await saved();
        open(`/runs/?run=${id}`, '_blank', 'noopener');
      }),
    ),
    status,
  );
}

function fetchTo(address, name) {
  const link = h('a', {href: address, download: name});
  document.body.append(link);
  link.click();
  link.remove();
}

function download(blob, name) {
  const address = URL.createObjectURL(blob);
  fetchTo(address, name);
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
