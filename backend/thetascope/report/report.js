// Draws the figures whose JSON stands in the page, one after another; nothing is fetched and nothing leaves. The width is
// given outright: Plotly's own resizing measures the height too, and loses the margins on the way.
const figures = JSON.parse(document.getElementById('figures').textContent);
const options = {
  responsive: false,
  displaylogo: false,
  showSendToCloud: false,
  plotlyServerURL: '',
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
};
const boxes = figures.map((_, place) => document.getElementById(`plot-${place}`));
const paper = 660; // pixels that fit on a page in print
const resizing = {pending: false, busy: false};
let small = null;

async function draw() {
  const same = small === innerWidth < 640;
  small = innerWidth < 640;
  for (const [place, {data, layout}] of figures.entries()) {
    const width = boxes[place].clientWidth;
    if (same) await Plotly.relayout(boxes[place], {width});
    else {
      await Plotly.react(boxes[place], data, {...structuredClone(layout), width}, options);
      if (small) await Plotly.relayout(boxes[place], structuredClone(layout.meta.narrow));
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
