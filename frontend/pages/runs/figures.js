// The figures of the run. Plotly is loaded when it is first needed; figures are fetched and drawn one after another,
// as they come near the screen.

import {connection, get, reason} from '../../common/api.js';
import {fill, h, query} from '../../common/dom.js';
import {plotlyLocale} from '../../i18n/plotly-locale.js';
import {named, t} from '../../i18n/words.js';
import {openPaper} from '../../widgets/paper/paper-dialog.js';

/** @import {FigureBox, Run, RunState, RunStore} from '../types.js' */

/** @import {PlotlyFigure, PlotlyLibrary} from '../../types/globals.js' */
/** @import * as service from '../../types/service.js' */

// Plotly offers by default to send the figure to its makers' cloud: not from here.
const OPTIONS = {
  displaylogo: false,
  responsive: false,
  showSendToCloud: false,
  plotlyServerURL: '',
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
};
/** @typedef {{[name: string]: unknown}} Part   of a layout */

const options = () => ({...OPTIONS, ...plotlyLocale()});
const PROJECTOR = 1.25;
const narrow = matchMedia('(max-width: 640px)');
const projector = matchMedia('(min-width: 1800px)');

/** @type {Promise<PlotlyLibrary> | null} */
let library = null;

function plotly() {
  library ??= new Promise((done, stop) => {
    const script = h('script', {
      src: '/assets/plotly.min.js',
      onload: () => done(window.Plotly),
      onerror: () => {
        library = null;
        script.remove();
        stop(new Error(t('page.runs.plotly-failed')));
      },
    });
    document.head.append(script);
  });
  return library;
}

/**
 * The layout for this screen: on a narrow one the server's own variant, on a projector everything larger. The width is
 * given outright: Plotly's own resizing measures the height too, and loses the margins on the way.
 * @param {PlotlyFigure['layout']} layout
 * @param {number} width
 */
function fitted(layout, width) {
  const copy = {...structuredClone(layout), width};
  if (narrow.matches) {
    for (const [path, value] of Object.entries(copy.meta?.narrow ?? {})) {
      const keys = path.split('.');
      const last = keys.pop() ?? '';
      const into = keys.reduce((at, key) => /** @type {Part} */ (at[key]), /** @type {Part} */ (copy));
      into[last] = value;
    }
  }
  return projector.matches ? enlarged(copy) : copy;
}

const LENGTHS = new Set(['size', 'height', 'l', 'r', 't', 'b', 'xshift', 'yshift', 'itemwidth', 'standoff']);

/** @param {Part} part */
function enlarged(part) {
  for (const [key, value] of Object.entries(part)) {
    if (typeof value === 'number' && LENGTHS.has(key)) part[key] = value * PROJECTOR;
    else if (typeof value === 'object' && value !== null && key !== 'meta') enlarged(/** @type {Part} */ (value));
  }
  return part;
}

/**
 * Draw a figure, or draw it anew, in the width that its element has.
 * @param {FigureBox['plot']} plot
 * @param {PlotlyFigure} figure
 */
export async function drawFigure(plot, figure) {
  const Plotly = await plotly();
  await Plotly.react(plot, figure.data, fitted(figure.layout, plot.clientWidth), options());
}

/** @param {HTMLElement} root @param {RunStore} store */
export function mountFigures(root, store) {
  /** @type {Map<string, FigureBox>} */
  const boxes = new Map();
  const bar = h('nav', {class: 'jump', 'aria-label': t('page.runs.figures')});
  /** @type {Promise<unknown>} */
  let queue = Promise.resolve();
  const near = new IntersectionObserver(
    (entries) => {
      for (const entry of entries)
        if (entry.isIntersecting) draw(boxes.get(entry.target.getAttribute('data-name') ?? ''));
    },
    {rootMargin: '500px'},
  );

  /** @param {() => unknown} work */
  function later(work) {
    queue = queue.then(work, work);
    return queue;
  }

  /** @param {Run} run */
  async function list(run) {
    try {
      /** @type {service.FigureList} */
      const {figures} = await get(run.links.figures);
      if (store.state.run !== run) return;
      const names = new Set(figures.map((one) => one.name));
      for (const [name, box] of boxes) if (!names.has(name)) remove(name, box);
      fill(
        bar,
        figures.map((one) => h('a', {href: `#figure-${one.name}`, onclick: jump}, named(one.title))),
      );
      root.replaceChildren(bar, ...figures.map((one) => section(one, run)));
      for (const box of boxes.values()) near.observe(box.section);
    } catch (error) {
      if (store.state.run === run)
        fill(
          root,
          failure(error, () => list(run)),
        );
    }
  }

  /** @param {MouseEvent & {currentTarget: HTMLElement}} event */
  function jump(event) {
    event.preventDefault(); // the address is the choice's
    query(event.currentTarget.getAttribute('href') ?? '').scrollIntoView();
  }

  /** @param {service.FigureLine} one @param {Run} run */
  function section(one, run) {
    const box = boxes.get(one.name) ?? create(one);
    near.unobserve(box.section); // observed again, so that a visible figure is redrawn
    return Object.assign(box, {address: `${run.links.figures}/${encodeURIComponent(one.name)}`, drawn: null}).section;
  }

  /** @param {service.FigureLine} one @returns {FigureBox} */
  function create(one) {
    const plot = h('div', {class: 'plot', role: 'img', 'aria-label': named(one.title)});
    /** @type {FigureBox} */
    const box = {
      plot,
      address: '',
      caption: h('figcaption'),
      drawn: null,
      section: h('figure', {class: 'card', id: `figure-${one.name}`, 'data-name': one.name}),
    };
    const paper = h(
      'button',
      {
        type: 'button',
        class: 'quiet',
        'aria-label': t('page.paper.open-of', {figure: named(one.title)}),
        onclick: () => openPaper(box.address, named(one.title)),
      },
      t('page.paper.open'),
    );
    box.section.append(h('div', {class: 'heading'}, h('h2', {}, named(one.title)), paper), box.caption, plot);
    boxes.set(one.name, box);
    return box;
  }

  /** @param {string} name @param {FigureBox} box */
  function remove(name, box) {
    near.unobserve(box.section);
    if (box.plot.data) window.Plotly.purge(box.plot);
    boxes.delete(name);
  }

  /** @param {FigureBox | undefined} box */
  function draw(box) {
    if (!box) return;
    const wanted = `${box.address}?theme=${window.theme.now}`;
    if (box.drawn === wanted) return;
    box.drawn = wanted;
    later(async () => {
      if (box.drawn !== wanted || !box.section.isConnected) return;
      try {
        const [Plotly, figure] = await Promise.all([plotly(), /** @type {Promise<PlotlyFigure>} */ (get(wanted))]);
        if (box.drawn !== wanted) return;
        box.failed?.remove();
        box.figure = figure;
        const {title, caption} = figure.layout.meta ?? {};
        fill(box.caption, named(caption));
        box.plot.setAttribute('aria-label', `${named(title)}. ${named(caption)}`);
        await Plotly.react(box.plot, figure.data, fitted(figure.layout, box.plot.clientWidth), options());
        box.section.dataset.drawn = wanted;
      } catch (error) {
        box.drawn = null;
        box.failed?.remove();
        box.failed = failure(error, () => draw(box));
        box.section.append(box.failed);
      }
    });
  }

  /** @param {unknown} error @param {() => void} again */
  const failure = (error, again) =>
    h(
      'div',
      {class: 'problem', role: 'alert'},
      h('b', {}, t('page.runs.figure-failed')),
      h('p', {}, reason(error).message),
      h('button', {type: 'button', class: 'quiet', onclick: again}, t('page.action.try-again')),
    );

  /**
   * Fit the figures to another size of the window.
   * @param {boolean} whole
   */
  function refit(whole) {
    for (const box of boxes.values()) {
      const {figure, plot} = box;
      if (!figure || !plot.data) continue;
      later(() =>
        whole
          ? window.Plotly.react(plot, figure.data, fitted(figure.layout, plot.clientWidth), options())
          : window.Plotly.relayout(plot, {width: plot.clientWidth}),
      );
    }
  }

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  addEventListener('resize', () => {
    clearTimeout(timer);
    timer = setTimeout(refit, 150, false);
  });
  for (const query of [narrow, projector]) query.addEventListener('change', () => refit(true));
  addEventListener('theme', () => {
    for (const box of boxes.values()) {
      near.unobserve(box.section);
      near.observe(box.section);
    }
  });

  /** @param {RunState} state */
  function showEmpty({spec, phase}) {
    const words =
      phase === 'running'
        ? h('h2', {}, t('page.runs.running'))
        : [h('h2', {}, t('page.runs.not-run')), h('p', {}, t('page.runs.not-run.hint'))];
    const lost = connection.lost && h('p', {}, t('page.problem.unreachable'));
    fill(root, spec || lost ? h('div', {class: 'empty card'}, spec ? words : lost) : null);
  }

  connection.addEventListener('change', () => store.state.spec || showEmpty(store.state));
  store.subscribe((state, before) => {
    if (state.run && state.run !== before.run) list(state.run);
    else if (!state.run && (state.spec !== before.spec || state.phase !== before.phase || before.run)) {
      for (const [name, box] of boxes) remove(name, box);
      showEmpty(state);
      if (state.spec) plotly().catch(() => {}); // ready when it is needed; a failure is shown then
    }
  });
}
