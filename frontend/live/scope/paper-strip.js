// A strip of the scope as a figure for a paper: the session is saved as a run, and the figure is the run's.

import {named} from '../../i18n/words.js';
import {openPaper} from '../../widgets/paper/paper-dialog.js';

/** @import {App, Strip} from '../types.js' */

/** The figure of a run that shows a strip, by the first part of the strip's name. @type {{[part: string]: string}} */
const FIGURES = {
  theta: 'faults',
  x: 'states',
  y: 'outputs',
  residual: 'residuals',
  relation: 'relations',
  excitation: 'excitation',
  r: 'inputs',
  u: 'inputs',
  signal: 'inputs',
};

/**
 * Save the session as a run and open the dialog for the figure that shows a strip, with the strip's panel.
 * @param {App} app
 * @param {Strip} strip
 * @throws {import('../../common/api.js').Problem} where the session cannot be saved
 */
export async function openStrip(app, strip) {
  const [part, ...rest] = strip.name.split('.');
  const figure = FIGURES[part] ?? 'faults';
  const {links, spec} = await app.act.save();
  const own = (spec.figures ?? []).some(({name}) => name === figure);
  const {channels = [], states = [], outputs = []} = app.state.plant ?? {};
  const items = {theta: channels, x: states, y: outputs, residual: outputs, relation: channels}[part] ?? [];
  const place = own ? -1 : items.findIndex(({name}) => name === rest.join('.'));
  openPaper(`${links.figures}/${figure}`, named(strip.title) || strip.name, place < 0 ? [] : [place + 1]);
}
