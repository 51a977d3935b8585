// The row of a strip: its label, canvas, values and buttons.

import {childrenOf, context, fill, h, symbol} from '../../common/dom.js';
import {badges, brief, plain, split, symbolic} from '../../common/names.js';
import {Range} from './axes.js';
import {openFigure} from './figure.js';
import {explain} from '../../widgets/explain.js';
import {truthOf} from './values.js';
import {t} from '../../i18n/words.js';

/** @import {App, Place, Plant, Row, Strip} from '../types.js' */

/** @typedef {{place: Place | null, ctx: CanvasRenderingContext2D}} Drawn   an object with a canvas */

/**
 * The title of a strip.
 * @param {Strip} strip
 * @returns {string}
 */
function titleOf({kind, title}) {
  if (kind === 'residual') return t('page.scope.residual');
  if (kind === 'relation') return t('page.scope.relation', {name: brief(title)});
  return kind === 'excitation' ? t('page.scope.excitation') : brief(title);
}

/**
 * Write a row's label, and make the cells of its values.
 * @param {Row} row
 * @param {App} app
 */
export function label(row, app) {
  const {strip} = row;
  const words = titleOf(strip);
  const [letters, index] = split(strip.symbol);
  const wordy =
    strip.kind === 'excitation' || strip.kind === 'relation' ? false : letters.length > 1 || index.length > 3;
  const unit = strip.unit ? ` ${strip.unit}` : '';
  const open = tool('open', 'M9.500 3H13v3.500M13 3L9 7M6.500 13H3V9.500M3 13l4-4', () => openFigure(app, strip.name));
  open.title = t('page.scope.open-figure');
  open.setAttribute('aria-label', t('page.scope.open-figure-of', {strip: words}));
  row.all.dataset.name = words;
  labelAll(row);
  const sign = h('span', {class: `sign${wordy ? ' wordy' : ''}`, role: 'term'}, signOf(strip, app.state.plant));
  explain(sign, () => t(`page.explain.${strip.kind}`, {strip: words}));
  // A student has not read the equations.
  const long = app.state.lesson && strip.unit ? `${words} (${strip.unit})` : words;
  fill(row.label, sign, open, h('small', {title: words + unit}, long));
  row.element.style.setProperty('--weight', String(strip.weight));
  row.element.dataset.kind = strip.kind;
  row.element.dataset.strip = strip.name;
  row.element.classList.toggle(
    'fault-on',
    strip.kind === 'theta' &&
      (app.state.lesson?.truth ?? true) &&
      app.state.faults.some(({subject, active}) => active && subject === strip.subject),
  );
  row.canvas.dataset.name = [symbolic(strip.symbol) && plain(strip.symbol), words].filter(Boolean).join(' ');
  row.canvas.setAttribute('aria-label', row.canvas.dataset.name);
  const own = strip.traces.map((trace) =>
    h('span', {
      style: `--c:${strip.log && strip.traces.length === 1 ? 'var(--ok)' : trace.colour}`,
      'data-label': trace.label,
      'data-name': trace.label,
    }),
  );
  fill(
    row.values,
    strip.truth && h('span', {class: 'truth', 'data-name': truthOf(strip)}),
    strip.reading &&
      h('span', {style: '--c:var(--soft)', 'data-label': strip.reading.label, 'data-name': strip.reading.label}),
    own,
    strip.log && own.length === 1 && h('span', {class: 'judged', style: '--c:var(--ok)', 'data-label': ''}),
  );
}

/**
 * Leave out the last of a row's values where not all have room; pointing at the others shows all of them.
 * @param {Row} row
 * @param {number} lines   that have room
 */
export function shorten({values}, lines) {
  const cells = childrenOf(values).filter((cell) => !cell.classList.contains('more-values'));
  const shown = cells.length <= Math.max(1, lines) ? cells.length : Math.max(1, lines - 1);
  cells.forEach((cell, place) => cell.classList.toggle('over', place >= shown));
  const left = cells.length - shown;
  let more = values.querySelector('.more-values');
  if (left === 0) more?.remove();
  else {
    if (!more) values.append((more = h('span', {class: 'more-values'})));
    more.textContent = t('page.scope.more-values', {n: left});
  }
  values.classList.toggle('short', left > 0);
}

/** @param {Row} row */
export function labelAll({all, whole}) {
  const action = whole ? t('page.scope.usual-axis') : t('page.scope.whole-axis');
  all.title = action;
  all.setAttribute('aria-label', t('page.scope.axis-of', {action, strip: all.dataset.name}));
  all.setAttribute('aria-pressed', String(Boolean(whole)));
}

/**
 * The symbol of a strip; a channel whose name is a word has the letters of its badge in the plant.
 * @param {Strip} strip
 * @param {Plant | null} plant
 */
export function signOf({kind, symbol: name}, plant) {
  if (kind === 'excitation') return h('span', {class: 'math'}, h('i', {}, 'λ'), h('sub', {}, 'min'));
  if (kind === 'residual')
    return h(
      'span',
      {class: 'math', style: split(name)[1].length > 5 && 'white-space:normal;font-size:1rem'},
      symbol(name),
      ' − ',
      symbol(name, true),
    );
  if (kind !== 'theta' && kind !== 'relation') return symbol(name);
  const [letters, index] = badges(plant?.channels ?? []).get(name) ?? split(name);
  if (kind === 'relation') return h('span', {class: 'math'}, h('i', {}, 'r'), h('sub', {}, letters + index));
  return h('span', {class: 'math'}, h('i', {}, letters), index && h('sub', {}, index));
}

/**
 * A small button of a strip.
 * @param {string} name
 * @param {string} d
 * @param {() => void} act
 */
export const tool = (name, d, act) =>
  h(
    'button',
    {type: 'button', class: name, onclick: act},
    h(
      'svg',
      {
        viewBox: '0 0 16 16',
        width: 13,
        height: 13,
        fill: 'none',
        stroke: 'currentColor',
        'stroke-width': 1.5,
        'stroke-linecap': 'round',
        'stroke-linejoin': 'round',
        'aria-hidden': 'true',
      },
      h('path', {d}),
    ),
  );

/**
 * A row without its strip: elements, an axis, and the button that shows all of the curves.
 * @param {() => void} showAll
 * @returns {Omit<Row, 'strip'>}
 */
export function createRow(showAll) {
  const label = h('div', {class: 'strip-label'});
  const canvas = h('canvas', {role: 'img'});
  const values = h('div', {class: 'strip-values', 'aria-hidden': 'true'});
  const mark = h('span', {class: 'unresolved', hidden: true});
  const all = tool('all', 'M8 2v12M5 4.500L8 2l3 2.500M5 11.500L8 14l3-2.500', showAll);
  const plot = h('div', {class: 'strip-plot'}, canvas, mark, all);
  return {
    label,
    canvas,
    values,
    plot,
    unresolved: mark,
    ctx: context(canvas),
    range: new Range(),
    element: h('div', {class: 'strip'}, label, plot, values),
    place: {left: 0, width: 0, height: 0, full: 0},
    all,
    whole: false,
  };
}

/**
 * Fit a canvas to its place, and set the scale of its pixels.
 * @param {Drawn} owner
 * @param {HTMLCanvasElement} canvas
 * @param {number} ratio
 * @param {number} gutter
 */
export function fit(owner, canvas, ratio, gutter) {
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  owner.ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  owner.place = {left: gutter, width: Math.max(0, width - gutter - 1), height, full: width};
}
