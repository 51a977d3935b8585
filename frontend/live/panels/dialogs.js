// What opens over the page: equations, the keys, sharing, exporting. One dialog element, filled when it is opened.

import {fill, h} from '../../dom.js';
import {showEquations} from './equations.js';
import {showExport} from './export.js';
import {showHelp} from './help.js';
import {showShare} from './share.js';
import {icon} from './svg.js';

const CONTENTS = {equations: showEquations, help: showHelp, share: showShare, export: showExport};
let show = () => {};

/** Open a dialog by name: equations, help, share, export. */
export const open = (name) => show(name);

export function mount(element, app) {
  const title = h('h2', {id: 'dialog-title'});
  const body = h('div', {class: 'dialog-body', tabindex: 0});
  const close = h('button', {type: 'button', class: 'plain', onclick: () => dialog.close()}, icon('close'));
  const dialog = h('dialog', {'aria-labelledby': 'dialog-title'}, h('div', {class: 'dialog-head'}, title, close), body);
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
  dialog.addEventListener('close', () => fill(body));
  fill(element, dialog);
  show = (name) => {
    if (dialog.open) dialog.close();
    dialog.dataset.name = name;
    close.setAttribute('aria-label', app.text.close);
    title.textContent = app.text.dialogs[name];
    CONTENTS[name](body, app, () => dialog.close());
    dialog.showModal();
  };
}
