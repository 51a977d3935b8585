// The dialogs: equations, keys, sharing, exporting. One dialog element, filled when it is opened.

import {fill, h} from '../../../common/dom.js';
import {showEquations} from '../../../widgets/equations.js';
import {showExport} from './export.js';
import {showHelp} from './help.js';
import {opens} from './open-dialog.js';
import {showShare} from './share.js';
import {icon} from '../../../widgets/svg.js';
import {t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */

/** @type {{[name: string]: (body: HTMLElement, app: App, close: () => void) => unknown}} */
const CONTENTS = {equations: showEquations, help: showHelp, share: showShare, export: showExport};
/** @type {{[name: string]: () => string}} */
const TITLES = {
  equations: () => t('page.equations.title'),
  help: () => t('page.help.title'),
  share: () => t('page.share.title'),
  export: () => t('page.export.title'),
};

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const title = h('h2', {id: 'dialog-title'});
  let body = h('div');
  const close = h('button', {type: 'button', class: 'plain', onclick: () => dialog.close()}, icon('close'));
  /** @type {HTMLDialogElement} */
  const dialog = h('dialog', {'aria-labelledby': 'dialog-title'}, h('div', {class: 'dialog-head'}, title, close));
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  // The event comes later than the dialog closes, and may find it open again with another body.
  dialog.addEventListener('close', () => dialog.open || body.remove());
  fill(element, dialog);
  opens((name) => {
    if (dialog.open) dialog.close();
    dialog.dataset.name = name;
    close.setAttribute('aria-label', t('page.action.close'));
    title.textContent = TITLES[name]();
    body.remove();
    body = h('div', {class: 'dialog-body', tabindex: 0}); // a new one: contents that come late go to their own
    dialog.append(body);
    CONTENTS[name](body, app, () => dialog.close());
    dialog.showModal();
  });
}
