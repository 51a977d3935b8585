// Draws the figures whose JSON is in the page, one after another. Nothing is fetched and nothing is sent. The width is
// set
// explicitly: Plotly's own resizing measures the height too, and loses the margins.

/** @import {PlotlyFigure} from '../../../frontend/types/globals.js' */

/** @type {PlotlyFigure[]} */
const figures = JSON.parse(document.getElementById('figures')?.textContent ?? '[]');
/** @type {{[english: string]: string}} */
const dictionary = JSON.parse(document.getElementById('plotly-words')?.textContent ?? '{}');
const locale = document.documentElement.lang;
const options = {
  locale,
  locales: {[locale]: {dictionary}},
  responsive: false,
  displaylogo: false,
  showSendToCloud: false,
  plotlyServerURL: '',
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
};
const boxes = figures.map((_, place) => /** @type {HTMLElement} */ (document.getElementById(`plot-${place}`)));
const paper = 660; // pixels that fit on a page in print
const resizing = {pending: false, busy: false};
/** @type {boolean | null} */
let small = null;

async function draw() {
  const same = small === innerWidth < 640;
  small = innerWidth < 640;
  for (const [place, {data, layout}] of figures.entries()) {
    const width = boxes[place].clientWidth;
    if (same) await Plotly.relayout(boxes[place], {width});
    else {
      await Plotly.react(boxes[place], data, {...structuredClone(layout), width}, options);
      if (small && layout.meta) await Plotly.relayout(boxes[place], structuredClone(layout.meta.narrow ?? {}));
    }
  }
}

async function redraw() {
  resizing.pending = true;
  if (resizing.busy) return;
  resizing.busy = true;
  while (resizing.pending) {
    resizing.pending = false;
    await draw();
  }
  resizing.busy = false;
}

redraw();
addEventListener('resize', redraw);
addEventListener('beforeprint', () => boxes.forEach((box) => Plotly.relayout(box, {width: paper})));
addEventListener('afterprint', redraw);
