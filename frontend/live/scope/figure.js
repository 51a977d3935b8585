// A strip, or the whole scope, as a figure: in a dialog to measure in, or as a picture to keep.

import {reason} from '../../common/api.js';
import {brief} from '../../common/names.js';
import {fill, h} from '../../common/dom.js';
import {figureOf, image, show} from './plotly-figure.js';
import {wanted} from './axis-view.js';
import {named, t} from '../../i18n/words.js';
import {refused} from '../actions.js';
import {openStrip} from './paper-strip.js';

/** @import {App, Strip} from '../types.js' */

const STRIP = 230; // px of height for each strip in a picture of all

/** @param {App} app @param {string | null} name */
function shown(app, name) {
  const all = app.strips();
  return name === null || name === undefined
    ? all.filter((strip) => strip.shown)
    : all.filter((strip) => strip.name === name);
}

/**
 * @param {App} app
 * @param {Strip[]} strips
 * @param {{span?: [number, number], whole?: boolean}} [options]
 */
function make(app, strips, {span = app.span(), whole = false} = {}) {
  const {state, samples} = app;
  const inSight = strips.map((strip) => ({
    ...strip,
    range: whole ? wanted(strip, samples, ...span, true) : rangeOf(app, strip.name),
  }));
  return figureOf({
    samples,
    strips: inSight,
    faults: state.faults,
    alarms: state.alarms,
    bands: app.scope.bands(),
    t0: span[0],
    t1: span[1],
    title: strips.length > 1 ? named(state.spec?.title) || (state.spec?.id ?? '') : null,
  });
}

/**
 * The present range of the strip's own axis.
 * @param {App} app
 * @param {string} name
 * @returns {[number, number] | null}
 */
function rangeOf(app, name) {
  const range = app.scope.rows.get(name)?.range;
  return range && Number.isFinite(range.low) ? [range.low, range.high] : null;
}

/**
 * A picture as a Blob: {strip: name or null for all that are shown, format: 'png' or 'svg'}.
 * @param {App} app
 * @param {{strip?: string | null, format?: 'png' | 'svg'}} [what]
 */
export function picture(app, {strip = null, format = 'png'} = {}) {
  const strips = shown(app, strip);
  return image(make(app, strips), {
    format,
    width: 1100,
    height: strips.length > 1 ? 90 + (STRIP * strips.length) / 1.6 : 420,
  });
}

/**
 * Open a strip as a figure over the page.
 * @param {App} app
 * @param {string} name
 */
export async function openFigure(app, name) {
  const [strip] = shown(app, name);
  if (!strip) return;
  const plot = h('div', {class: 'plot'}, h('p', {class: 'soft'}, t('page.scope.drawing')));
  /** @param {'png' | 'svg'} format */
  const keep = async (format) => {
    const address = URL.createObjectURL(await picture(app, {strip: name, format}));
    h('a', {href: address, download: `${app.state.spec?.id}-${strip.name.replaceAll('.', '-')}.${format}`}).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
  };
  async function forPaper() {
    try {
      await openStrip(app, strip);
    } catch (error) {
      fill(plot, h('p', {class: 'alarm'}, refused(error)));
    }
  }
  /** @param {string} words @param {() => void} act */
  const button = (words, act) => h('button', {type: 'button', class: 'quiet', onclick: act}, words);
  const dialog = h(
    'dialog',
    {
      class: 'figure-dialog',
      'aria-label': brief(strip.title) || strip.name,
      onclose: () => {
        if ('data' in plot) window.Plotly.purge(plot);
        dialog.remove();
      },
    },
    h(
      'div',
      {class: 'heading'},
      h('h2', {}, brief(strip.title) || strip.name),
      h('span', {class: 'grow'}),
      button('PNG', () => keep('png')),
      button('SVG', () => keep('svg')),
      app.state.role !== 'view' && button(t('page.paper.open'), forPaper),
      button(t('page.action.close'), () => dialog.close()),
    ),
    plot,
  );
  document.body.append(dialog);
  dialog.showModal();
  try {
    const figure = make(app, [strip], {whole: true}); // whatever leaves the axis of the strip is seen here
    fill(plot);
    await show(plot, figure);
  } catch (error) {
    fill(plot, h('p', {class: 'alarm'}, reason(error).message));
  }
}
