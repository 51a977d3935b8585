// The panels around the scope: the place of each, and the module that fills it.

import {query} from '../common/dom.js';
import {mountFirstSight} from './ui/first-sight.js';

/** @type {[place: string | null, module: string][]} */
const PANELS = [
  ['panel-header', 'header/header'],
  ['panel-title', 'header/title'],
  ['panel-plant', 'plant/plant'],
  ['panel-truth', 'truth/truth'],
  ['panel-inputs', 'inputs/inputs'],
  ['panel-inject', 'inject/inject'],
  ['panel-try', 'try'],
  ['panel-diagnosis', 'diagnosis'],
  ['panel-observers', 'observers/observers'],
  ['panel-comparison', 'comparison/comparison'],
  ['panel-table', 'comparison/table'],
  ['panel-log', 'log'],
  ['panel-dialogs', 'dialogs/dialogs'],
  [null, 'dialogs/keyboard'],
];

/** @import {App} from './types.js' */

/** @typedef {{mount: (element: HTMLElement, app: App) => void}} Panel */

/**
 * Load every panel, then mount them together, so that keys work as soon as there is something to see. A panel that
 * fails leaves its place empty.
 * @param {App} app
 */
export async function mountPanels(app) {
  const loaded = await Promise.allSettled(
    PANELS.map(([, name]) => /** @type {Promise<Panel>} */ (import(`./panels/${name}.js`))),
  );
  PANELS.forEach(([id, name], place) => {
    try {
      const panel = loaded[place];
      if (panel.status === 'rejected') throw panel.reason;
      panel.value.mount(id === null ? document.body : query(`#${id}`), app);
    } catch (error) {
      console.error(`panel ${name}:`, error);
    }
  });
  mountFirstSight(app);
}
