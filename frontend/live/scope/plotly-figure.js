// Figures of the strips with Plotly.js, which is loaded with the first of them. The live curves are drawn by canvas.js.

import {COLOURS} from '../../widgets/line-style.js';
import {h} from '../../common/dom.js';
import {brief, plain, symbolic} from '../../common/names.js';
import {palette} from './canvas.js';
import {plotlyLocale} from '../../i18n/plotly-locale.js';
import {t} from '../../i18n/words.js';
import {truthOf} from './values.js';

/** @import {PlotlyFigure} from '../../types/globals.js' */
/** @import {Alarm, FaultState, Palette, Samples, Strip} from '../types.js' */

/** @typedef {Strip & {range?: [number, number] | null}} FigureStrip */
/** @typedef {{type: string, [name: string]: unknown}} Shape */
/** @typedef {{shapes: Shape[], annotations: object[]}} Marks */

/**
 * @typedef {object} FigureOptions
 * @property {Samples} samples
 * @property {FigureStrip[]} strips
 * @property {FaultState[]} faults
 * @property {Alarm[]} alarms
 * @property {Set<string>} bands   observers whose bands are drawn
 * @property {number} t0
 * @property {number} t1
 * @property {string | null} title
 */

const MOST = 2500; // points of a curve; more are put together as minima and maxima
const OPTIONS = {
  displaylogo: false,
  responsive: true,
  showSendToCloud: false,
  plotlyServerURL: '',
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d', 'toImage'],
};

const TINT = 'rgba(230,159,0,.15)'; // where a fault acts

let library = null;

/** window.Plotly, from this server. */
export function load() {
  library ??= new Promise((done, stop) => {
    const script = h('script', {
      src: '/assets/plotly.min.js',
      onload: () => done(window.Plotly),
      onerror: () => {
        library = null;
        script.remove();
        stop(new Error('/assets/plotly.min.js'));
      },
    });
    document.head.append(script);
  });
  return library;
}

/**
 * A column between two times as {x, y}: all its rows, or the minimum and maximum of each bin.
 * @param {Samples} samples
 * @param {string} name
 * @param {number} t0
 * @param {number} t1
 * @returns {{x: number[], y: (number | null)[]}}
 */
export function points(samples, name, t0, t1) {
  const first = Math.max(0, Math.floor(t0 / samples.record));
  const last = Math.min(samples.rows, Math.ceil(t1 / samples.record) + 1);
  const power = samples.power(first, last, last - first <= MOST ? last - first : MOST / 2);
  const source = samples.source(name, power);
  /** @type {number[]} */
  const x = [];
  /** @type {(number | null)[]} */
  const y = [];
  if (!source) return {x, y};
  const each = source.rows;
  for (let bin = Math.floor(first / each); bin * each < last; bin += 1) {
    const a = source.low[bin & source.mask];
    const b = source.high[bin & source.mask];
    x.push(bin * each * samples.record);
    y.push(a === a ? a : null);
    if (each === 1) continue;
    x.push((bin + 0.5) * each * samples.record);
    y.push(b === b ? b : null);
  }
  return {x, y};
}

/**
 * Strips between two times as a Plotly figure, one above the other on one time axis.
 * @param {FigureOptions} options
 * @returns {PlotlyFigure}
 */
export function figureOf({samples, strips, faults, alarms, bands, t0, t1, title}) {
  const colours = palette();
  /** @type {PlotlyFigure['data']} */
  const data = [];
  /** @type {Marks} */
  const drawn = {shapes: [], annotations: []};
  /** @type {PlotlyFigure['layout']} */
  const layout = layoutOf({colours, title, t0, t1, axis: `y${strips.length > 1 ? strips.length : ''}`});
  const total = strips.reduce((sum, {weight}) => sum + weight, 0);
  const listed = new Set();
  let top = 1;
  strips.forEach((strip, i) => {
    const axis = `y${i ? i + 1 : ''}`;
    const high = (strip.weight / total) * (1 - 0.03 * (strips.length - 1));
    layout[`yaxis${i ? i + 1 : ''}`] = {
      domain: [Math.max(0, top - high), top],
      title: {text: nameOf(strip), standoff: 6},
      gridcolor: colours.grid,
      linecolor: colours.line,
      zerolinecolor: colours.line,
      mirror: true,
      ...(strip.range ? {range: strip.range} : {}),
      ...(strip.log ? {tickprefix: '10<sup>', ticksuffix: '</sup>', dtick: 1} : {}),
    };
    top -= high + 0.03;
    data.push(...curvesOf(strip, axis, {samples, t0, t1, colours, listed, bands}));
    if (strip.kind === 'theta') drawn.shapes.push(...tintsOf(strip, axis, faults, t0, t1, samples.now));
    if (strip.threshold !== null)
      drawn.shapes.push({
        type: 'line',
        xref: 'x',
        yref: axis,
        x0: t0,
        x1: t1,
        y0: strip.threshold,
        y1: strip.threshold,
        line: {color: colours.alarm, width: 1, dash: 'dot'},
      });
    drawn.annotations.push(...flagsOf(strip, axis, alarms, t0, t1, colours));
  });
  data.push(...keysOf(drawn, strips, colours));
  return {data, layout: {...layout, ...drawn}};
}

/**
 * The marks of a figure as entries of its legend: curves without points.
 * @param {Marks} marks
 * @param {FigureStrip[]} strips
 * @param {Palette} colours
 */
function keysOf({shapes, annotations}, strips, colours) {
  /** @param {string} name @param {object} look */
  const entry = (name, look) => ({
    type: 'scatter',
    mode: 'markers',
    x: [null],
    y: [null],
    name,
    hoverinfo: 'skip',
    showlegend: true,
    ...look,
  });
  const entries = [
    shapes.some(({type}) => type === 'rect') &&
      entry(t('page.scope.fault-active'), {marker: {symbol: 'square', size: 11, color: TINT}}),
    annotations.length > 0 &&
      entry(t('page.scope.alarm'), {marker: {symbol: 'triangle-down', size: 10, color: colours.alarm}}),
    strips.some(({threshold}) => threshold !== null) &&
      entry(t('page.scope.threshold'), {mode: 'lines', line: {color: colours.alarm, width: 1, dash: 'dot'}}),
  ];
  return entries.filter((one) => one !== false);
}

/**
 * Alarms on the strip that they name, as flags at its upper edge.
 * @param {FigureStrip} strip
 * @param {string} axis
 * @param {Alarm[]} alarms
 * @param {number} t0
 * @param {number} t1
 * @param {Palette} colours
 */
function flagsOf(strip, axis, alarms, t0, t1, colours) {
  /** @param {Alarm} alarm */
  const names = ({explained, subject, subjects}) =>
    strip.kind === 'theta'
      ? subjects.includes(strip.subject)
      : strip.kind === 'residual' && !explained && subject === strip.subject;
  return alarms
    .filter((alarm) => names(alarm) && alarm.t >= t0 && alarm.t <= t1)
    .map(({t: at, subject}) => ({
      x: at,
      y: 1,
      xref: 'x',
      yref: `${axis} domain`,
      xanchor: 'center',
      yanchor: 'middle',
      text: subject === strip.subject ? '▼' : '▽',
      showarrow: false,
      font: {color: colours.alarm, size: 11 * colours.size},
    }));
}

/** @param {{colours: Palette, title: string | null, t0: number, t1: number, axis: string}} options */
function layoutOf({colours, title, t0, t1, axis}) {
  return {
    paper_bgcolor: colours.card,
    plot_bgcolor: colours.card,
    margin: {l: 84, r: 16, t: title ? 74 : 40, b: 42},
    hovermode: 'x unified',
    font: {family: 'system-ui, "Noto Sans", "DejaVu Sans", sans-serif', size: 12 * colours.size, color: colours.ink},
    legend: {orientation: 'h', y: 1.005, yanchor: 'bottom', x: 0, xanchor: 'left'},
    title: title
      ? {
          text: escaped(title),
          x: 0.01,
          y: 1,
          yref: 'container',
          yanchor: 'top',
          pad: {t: 14},
          font: {size: 14 * colours.size},
        }
      : undefined,
    xaxis: {
      title: {text: 't / s'},
      range: [t0, t1],
      gridcolor: colours.grid,
      linecolor: colours.line,
      zeroline: false,
      anchor: axis,
    },
  };
}

/**
 * Bands, estimates and truth of a strip; each name is in the legend once.
 * @param {FigureStrip} strip
 * @param {string} axis
 * @param {Pick<FigureOptions, 'samples' | 't0' | 't1' | 'bands'> & {colours: Palette, listed: Set<string>}} options
 */
function curvesOf(strip, axis, {samples, t0, t1, colours, listed, bands}) {
  const base = {type: 'scatter', mode: 'lines', xaxis: 'x', yaxis: axis};
  const edge = {...base, line: {width: 0}, hoverinfo: 'skip', showlegend: false};
  const shown = strip.traces.filter(({label}) => bands.has(label)).reverse();
  const banded = shown.filter(({low}) => low).length;
  const areas = shown.flatMap((trace) => {
    if (trace.low === undefined || trace.high === undefined) return [];
    const name = t('page.scope.band-of', {label: trace.label});
    const showlegend = !listed.has(name);
    listed.add(name);
    return [
      {...edge, ...points(samples, trace.low, t0, t1), legendgroup: name},
      {
        ...edge,
        ...points(samples, trace.high, t0, t1),
        name: escaped(name),
        legendgroup: name,
        showlegend,
        fill: 'tonexty',
        fillcolor: `${colours.observers[trace.place % COLOURS]}${banded > 2 ? '1c' : '2b'}`,
      },
    ];
  });
  /**
   * @param {string} column
   * @param {string} name
   * @param {object} line
   */
  const curve = (column, name, line) => {
    const showlegend = !listed.has(name);
    listed.add(name);
    return {...base, ...points(samples, column, t0, t1), name: escaped(name), legendgroup: name, showlegend, line};
  };
  return [
    ...areas,
    ...strip.traces.map((trace) =>
      curve(trace.column, trace.label, {
        color: colours.observers[trace.place % COLOURS],
        width: 1.4,
        ...(trace.dashed ? {dash: 'dashdot'} : {}),
      }),
    ),
    ...(strip.reading ? [curve(strip.reading.column, strip.reading.label, {color: colours.soft, width: 1.2})] : []),
    ...(strip.truth ? [curve(strip.truth, truthOf(strip), {color: colours.ink, width: 1.2, dash: 'dash'})] : []),
  ];
}

/**
 * The times at which a fault acts, as areas behind the curves.
 * @param {FigureStrip} strip
 * @param {string} axis
 * @param {FaultState[]} faults
 * @param {number} t0
 * @param {number} t1
 * @param {number} now
 */
function tintsOf(strip, axis, faults, t0, t1, now) {
  return faults
    .filter(({subject, onset}) => subject === strip.subject && onset <= t1)
    .map(({onset, end}) => ({
      type: 'rect',
      xref: 'x',
      yref: `${axis} domain`,
      x0: Math.max(t0, onset),
      x1: Math.min(t1, end ?? now),
      y0: 0,
      y1: 1,
      fillcolor: TINT,
      line: {width: 0},
      layer: 'below',
    }));
}

/**
 * Text that Plotly is not to read as its own markup.
 * @param {string} words
 */
const escaped = (words) => words.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');

/** @param {FigureStrip} strip */
function nameOf(strip) {
  const name = symbolic(strip.symbol) ? plain(strip.symbol) : brief(strip.title) || plain(strip.symbol);
  const residual =
    (strip.kind === 'residual' && t('page.scope.residual-of', {name})) ||
    (strip.kind === 'relation' && t('page.scope.relation', {name: brief(strip.title)}));
  const words = strip.kind === 'excitation' ? t('page.scope.excitation') : residual || name;
  return escaped(words + (strip.unit ? ` / ${strip.unit}` : ''));
}

/**
 * Draw a figure into an element.
 * @param {HTMLElement} element
 * @param {PlotlyFigure} figure
 */
export async function show(element, figure) {
  const Plotly = await load();
  await Plotly.newPlot(element, figure.data, figure.layout, {...OPTIONS, ...plotlyLocale()});
  return Plotly;
}

/**
 * A figure as a Blob: format 'png' or 'svg'.
 * @param {PlotlyFigure} figure
 * @param {{format: 'png' | 'svg', width: number, height: number}} options
 */
export async function image(figure, {format, width, height}) {
  const Plotly = await load();
  const address = await Plotly.toImage(figure, {
    format,
    width,
    height,
    scale: format === 'png' ? 2 : 1,
    imageDataOnly: true,
  });
  if (format === 'svg') return new Blob([address], {type: 'image/svg+xml'});
  return new Blob([Uint8Array.from(atob(address), (letter) => letter.charCodeAt(0))], {type: 'image/png'});
}
