// Figures of a study: median and spread, ROC, compromises, parallel axes. Drawn by Plotly in the page's colours.

import {t} from '../../i18n/words.js';
import {drawFigure} from '../runs/figures.js';

/** @import {FigureBox} from '../types.js' */
/** @import {PlotlyFigure} from '../../types/globals.js' */
/** @import * as service from '../../types/service.js' */

const COLOURS = 6;
/** @typedef {{[name: string]: unknown}} Part */

/** @param {string} name */
const token = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** @param {number} place */
const colour = (place) => token(`--o${place % COLOURS}`);

/** A colour with an opacity. @param {string} hex @param {number} opacity */
const faint = (hex, opacity) =>
  `${hex}${Math.round(opacity * 255)
    .toString(16)
    .padStart(2, '0')}`;

/** On a logarithmic axis 1, 2 and 5 of each decade. @param {Part} axis */
const ticks = (axis) => (axis.type === 'log' ? {dtick: 'D2'} : {});

/** @param {Part} x @param {Part} y @param {Part} [more] */
function layout(x, y, more = {}) {
  const line = {gridcolor: token('--line'), linecolor: token('--line'), zeroline: false, automargin: true};
  return {
    height: 300,
    margin: {l: 64, r: 16, t: 12, b: 52},
    paper_bgcolor: 'rgba(0,0,0,0)',
    plot_bgcolor: 'rgba(0,0,0,0)',
    font: {family: token('--ui'), size: 12, color: token('--ink')},
    hoverlabel: {bgcolor: token('--card'), bordercolor: token('--line'), font: {color: token('--ink')}},
    showlegend: false,
    xaxis: {...line, ...ticks(x), ...x},
    yaxis: {...line, ...ticks(y), ...y},
    ...more,
  };
}

/**
 * The range of an axis whose numbers are all the same, for which Plotly takes ±1.
 * @param {readonly (number | null)[]} values
 */
function span(values) {
  const [first] = values;
  if (typeof first !== 'number' || first === 0 || values.some((value) => value !== first)) return {};
  return {range: [Math.min(0.8 * first, 1.2 * first), Math.max(0.8 * first, 1.2 * first)]};
}

/** @param {string} text */
const title = (text) => ({text, font: {color: token('--soft'), size: 12}, standoff: 8});

/**
 * Whether numbers are better shown on a logarithmic axis.
 * @param {readonly (number | string | null)[]} values
 */
function wide(values) {
  const numbers = values.filter((value) => typeof value === 'number');
  const least = Math.min(...numbers);
  return numbers.length === values.length && numbers.length > 2 && least > 0 && Math.max(...numbers) / least > 20;
}

/**
 * @param {FigureBox['plot']} plot
 * @param {unknown[]} data
 * @param {unknown} shape
 * @param {(run: number) => void} [open]   is called with the run of a point that is clicked
 */
async function show(plot, data, shape, open) {
  await drawFigure(plot, /** @type {PlotlyFigure} */ ({data, layout: shape}));
  const events = /** @type {{on?: (name: string, then: (event: {points: {customdata?: unknown}[]}) => void) => void,
    removeAllListeners?: (name: string) => void}} */ (/** @type {unknown} */ (plot));
  events.removeAllListeners?.('plotly_click');
  if (open)
    events.on?.('plotly_click', (event) => {
      const run = event.points[0]?.customdata;
      if (typeof run === 'number') open(run);
    });
}

/**
 * A measure against a factor: the median with the middle half of the runs, or the share with its interval.
 * @param {FigureBox['plot']} plot
 * @param {readonly service.CurvePoint[]} points
 * @param {string} measure
 * @param {string} against
 * @param {(run: number) => void} open
 */
export async function drawCurves(plot, points, measure, against, open) {
  /** @type {Map<string, service.CurvePoint[]>} */
  const curves = new Map();
  for (const point of points) {
    const name = point.curve === null ? '' : String(point.curve);
    curves.set(name, [...(curves.get(name) ?? []), point]);
  }
  const rate = points.some((point) => point.rate);
  const data = [...curves].flatMap(([name, all], place) => {
    const mine = all.filter((point) => (rate ? point.rate?.of : point.spread.median !== null));
    const x = mine.map((point) => point.value);
    /** @param {service.CurvePoint} point @returns {(number | null)[]} */
    const band = (point) =>
      point.rate
        ? [point.rate.low, point.rate.count / point.rate.of, point.rate.high]
        : [point.spread.low, point.spread.median, point.spread.high];
    const lows = mine.map((point) => band(point)[0]);
    const highs = mine.map((point) => band(point)[2]);
    const hex = colour(place);
    return [
      {
        type: 'scatter',
        mode: 'lines',
        x: [...x, ...x.toReversed()],
        y: [...highs, ...lows.toReversed()],
        fill: 'toself',
        fillcolor: faint(hex, 0.16),
        line: {width: 0},
        showlegend: false,
        hoverinfo: 'skip',
      },
      {
        type: 'scatter',
        mode: 'lines+markers',
        name,
        x,
        y: mine.map((point) => band(point)[1]),
        customdata: mine.map((point) => point.run),
        line: {color: hex, width: 2},
        marker: {color: hex, size: 8},
        hovertemplate: `%{x}: %{y:.4g}<extra>${name}</extra>`,
      },
    ];
  });
  const values = points.map((point) => point.spread.median);
  await show(
    plot,
    data,
    layout(
      {title: title(against), type: wide(points.map((point) => point.value)) ? 'log' : '-'},
      {
        title: title(measure),
        type: !rate && wide(values) ? 'log' : '-',
        ...(rate ? {tickformat: '.0%', range: [-0.02, 1.02]} : {}),
      },
      {showlegend: curves.size > 1, legend: {orientation: 'h', y: 1.16, x: 0}, margin: {l: 64, r: 16, t: 34, b: 52}},
    ),
    open,
  );
}

/**
 * Alarms without faults against faults found.
 * @param {FigureBox['plot']} plot
 * @param {readonly service.RocPointAnswer[]} points
 */
export async function drawRoc(plot, points) {
  const known = points.filter((point) => point.false.of && point.found.of);
  /** @param {(point: service.RocPointAnswer) => service.RateAnswer} of */
  const errors = (of) => ({
    type: 'data',
    symmetric: false,
    array: known.map((point) => of(point).high - of(point).count / of(point).of),
    arrayminus: known.map((point) => of(point).count / of(point).of - of(point).low),
    color: faint(colour(3), 0.5),
    thickness: 1.2,
  });
  await show(
    plot,
    [
      {
        type: 'scatter',
        mode: 'lines+markers+text',
        x: known.map((point) => point.false.count / point.false.of),
        y: known.map((point) => point.found.count / point.found.of),
        error_x: errors((point) => point.false),
        error_y: errors((point) => point.found),
        text: known.map((point) => String(point.value)),
        textposition: 'bottom right',
        line: {color: colour(3), width: 2},
        marker: {color: colour(3), size: 8},
        hovertemplate: '%{text}: %{x:.1%}, %{y:.1%}<extra></extra>',
      },
    ],
    layout(
      {title: title(t('page.studies.roc.x')), tickformat: '.0%', range: [-0.02, 1.02]},
      {title: title(t('page.studies.roc.y')), tickformat: '.0%', range: [-0.02, 1.05]},
    ),
  );
}

/**
 * What is found of faults of each size, and below it how soon.
 * @param {FigureBox['plot']} plot
 * @param {readonly service.ChannelSizes[]} channels
 * @param {string} against
 * @param {(run: number) => void} open
 */
export async function drawSizes(plot, channels, against, open) {
  const data = channels.flatMap(({channel, points}, place) => {
    const hex = colour(place);
    const found = points.filter((point) => point.found.of);
    const late = points.filter((point) => point.delay.median !== null);
    /** @param {readonly service.SizeAnswer[]} some */
    const base = (some) => ({
      type: 'scatter',
      mode: 'lines+markers',
      name: channel,
      legendgroup: channel,
      x: some.map((point) => point.size),
      customdata: some.map((point) => point.run),
      line: {color: hex, width: 2},
      marker: {color: hex, size: 8},
    });
    /** @param {(number | null)[]} high @param {(number | null)[]} low */
    const bars = (high, low) => ({
      type: 'data',
      symmetric: false,
      array: high,
      arrayminus: low,
      color: faint(hex, 0.5),
      thickness: 1.2,
    });
    const shares = found.map((point) => point.found.count / point.found.of);
    const medians = late.map((point) => point.delay.median ?? 0);
    return [
      {
        ...base(found),
        y: shares,
        error_y: bars(
          found.map((point, i) => point.found.high - shares[i]),
          found.map((point, i) => shares[i] - point.found.low),
        ),
        hovertemplate: `%{x:.4g}: %{y:.1%}<extra>${channel}</extra>`,
      },
      {
        ...base(late),
        showlegend: false,
        yaxis: 'y2',
        y: medians,
        error_y: bars(
          late.map((point, i) => (point.delay.high ?? 0) - medians[i]),
          late.map((point, i) => medians[i] - (point.delay.low ?? 0)),
        ),
        hovertemplate: `%{x:.4g}: %{y:.3g} s<extra>${channel}</extra>`,
      },
    ];
  });
  const sizes = channels.flatMap(({points}) => points.map((point) => point.size));
  const delays = {title: title(t('page.studies.sizes.delay')), gridcolor: token('--line'), zeroline: false};
  await show(
    plot,
    data,
    layout(
      {title: title(against), type: wide(sizes) ? 'log' : '-', anchor: 'y2'},
      {title: title(t('page.studies.sizes.found')), tickformat: '.0%', range: [-0.04, 1.08], domain: [0.56, 1]},
      {
        yaxis2: {...delays, linecolor: token('--line'), automargin: true, rangemode: 'tozero', domain: [0, 0.46]},
        showlegend: channels.length > 1,
        legend: {orientation: 'h', y: 1.16, x: 0},
        margin: {l: 64, r: 16, t: channels.length > 1 ? 34 : 12, b: 52},
        height: 380,
      },
    ),
    open,
  );
}

/**
 * All points by two measures; those that no other beats are joined.
 * @param {FigureBox['plot']} plot
 * @param {readonly service.CompromiseAnswer[]} points
 * @param {string} a
 * @param {string} b
 * @param {(run: number) => void} choose
 */
export async function drawCompromises(plot, points, a, b, choose) {
  const best = points.filter((point) => point.best).sort((one, other) => one.a - other.a);
  const rest = points.filter((point) => !point.best);
  /** @param {readonly service.CompromiseAnswer[]} some @param {string} hex @param {Part} more */
  const trace = (some, hex, more) => ({
    type: 'scatter',
    x: some.map((point) => point.a),
    y: some.map((point) => point.b),
    customdata: some.map((point) => point.run),
    text: some.map((point) => describe(point.values)),
    marker: {color: hex, size: 9},
    hovertemplate: '%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>',
    ...more,
  });
  await show(
    plot,
    [
      trace(rest, token('--soft'), {mode: 'markers', marker: {color: faint(token('--soft'), 0.6), size: 7}}),
      trace(best, colour(0), {mode: 'lines+markers', line: {color: colour(0), width: 1.5}}),
    ],
    layout(
      {title: title(a), type: wide(points.map((point) => point.a)) ? 'log' : '-', ...span(points.map((one) => one.a))},
      {title: title(b), type: wide(points.map((point) => point.b)) ? 'log' : '-', ...span(points.map((one) => one.b))},
    ),
    choose,
  );
}

/** @param {{[name: string]: number | string}} values */
export const describe = (values) =>
  Object.entries(values)
    .map(([name, value]) => `${name.split('.').slice(-2).join('.')} = ${brief(value)}`)
    .join(', ');

/** @param {number | string} value */
export const brief = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(4))) : value);

/**
 * One line for each point across an axis for each factor and measure.
 * @param {FigureBox['plot']} plot
 * @param {service.PointAnswers} table
 * @param {readonly string[]} factors
 * @param {(run: number) => void} open
 */
export async function drawParallel(plot, table, factors, open) {
  const axes = [...factors, ...table.measures];
  /** @param {service.PointAnswer} point @param {number} place */
  const value = (point, place) =>
    place < factors.length ? point.values[factors[place]] : point.numbers[place - factors.length];
  const scales = axes.map((_, place) => {
    const all = table.points.map((point) => value(point, place)).filter((one) => one !== null);
    const numbers = all.filter((one) => typeof one === 'number');
    if (numbers.length === all.length && all.length) return scaleOf(numbers);
    const names = [...new Set(all.map(String))];
    return {
      at: (/** @type {unknown} */ one) => (names.length > 1 ? names.indexOf(String(one)) / (names.length - 1) : 0.5),
      low: names[0] ?? '',
      high: names.at(-1) ?? '',
    };
  });
  const last = table.points.map((point) => point.numbers[0] ?? null);
  const ends = scaleOf(last.filter((one) => one !== null));
  const data = table.points.slice(0, 500).map((point) => {
    const share = typeof point.numbers[0] === 'number' ? ends.at(point.numbers[0]) : 0.5;
    return {
      type: 'scatter',
      mode: 'lines',
      x: axes.map((_, place) => place),
      y: axes.map((_, place) => {
        const one = value(point, place);
        return one === null ? null : scales[place].at(one);
      }),
      customdata: axes.map(() => point.run),
      text: axes.map((_, place) => brief(value(point, place) ?? '–')),
      line: {color: faint(colour(share > 0.5 ? 1 : 0), 0.25 + 0.6 * Math.abs(share - 0.5)), width: 1.5},
      hovertemplate: `${describe(point.values)}<br>%{text}<extra></extra>`,
    };
  });
  const labels = axes.map((name) => name.split('.').slice(-2).join('.'));
  await show(
    plot,
    data,
    layout(
      {tickvals: axes.map((_, place) => place), ticktext: labels, showgrid: true, range: [-0.2, axes.length - 0.8]},
      {visible: false, range: [-0.12, 1.12]},
      {
        height: 440,
        hovermode: 'closest',
        margin: {l: 70, r: 70, t: 24, b: 60},
        annotations: scales.flatMap(({low, high}, place) =>
          [low, high].map((text, end) => ({
            x: place,
            y: end ? 1.08 : -0.08,
            text: brief(text),
            showarrow: false,
            font: {size: 11, color: token('--soft')},
          })),
        ),
      },
    ),
    open,
  );
}

/** The place of a number between the least and the greatest. @param {readonly number[]} numbers */
function scaleOf(numbers) {
  const low = Math.min(...numbers);
  const high = Math.max(...numbers);
  const logarithmic = wide(numbers);
  /** @param {number} value */
  const of = (value) => (logarithmic ? Math.log(value) : value);
  return {
    at: (/** @type {unknown} */ one) => (high > low ? (of(Number(one)) - of(low)) / (of(high) - of(low)) : 0.5),
    low,
    high,
  };
}
