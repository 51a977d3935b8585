// Script time of one update of the live page's scope: 33 new rows and 4 strips of 3 curves with 10 000 points each;
// beside it what Plotly
// takes for the same curves. Run in the page by benchmarks/page.py: async ({updates}) => …

async ({updates}) => {
  const modules = ['state/samples', 'scope/canvas', 'scope/axes', 'scope/plotly-figure'].map(
    (name) => import(`/live/${name}.js`),
  );
  const [{Samples}, {drawStrip, palette}, {Range}, {load, points}] = await Promise.all(modules);
  const samples = new Samples(0.01);
  const names = [0, 1, 2, 3].flatMap((strip) => [0, 1, 2].map((observer) => `o${observer}.x.s${strip}`));
  samples.setColumns(names);
  const rows = (count) =>
    Float32Array.from({length: names.length * count}, (_, k) => Math.sin(k * 0.003) + 0.2 * Math.random());
  const push = (data) => samples.push(samples.rows, data.length / names.length, data);
  for (let i = 0; i < 20; i += 1) push(rows(1000));
  const colours = palette();
  const strips = [0, 1, 2, 3].map((strip) => {
    const canvas = Object.assign(document.createElement('canvas'), {width: 700, height: 180});
    canvas.style.cssText = 'position:fixed;left:0;top:0;opacity:.01;pointer-events:none';
    document.body.append(canvas);
    const range = new Range();
    range.aim(-1.5, 1.5, 0, true);
    const traces = [0, 1, 2].map((place) => ({
      label: `o${place}`,
      place,
      fallen: null,
      column: `o${place}.x.s${strip}`,
    }));
    return {
      canvas,
      ctx: canvas.getContext('2d'),
      range,
      strip: {
        kind: 'state',
        subject: '',
        log: false,
        threshold: null,
        truth: null,
        ticks: [-1, 0, 1],
        labels: ['−1', '0', '1'],
        power: '',
        traces,
      },
    };
  });
  const place = {left: 46, width: 650, height: 180, full: 700};
  const own = [];
  const begun = performance.now();
  for (let k = 0; k < updates; k += 1) {
    const data = rows(33);
    const began = performance.now();
    push(data);
    const view = {
      t0: samples.now - 100,
      t1: samples.now,
      step: 20,
      samples,
      ghost: null,
      now: samples.now,
      faults: [],
      alarms: [],
      bands: new Set(),
    };
    for (const {ctx, strip, range} of strips) drawStrip(ctx, strip, place, view, range, colours);
    own.push((performance.now() - began) / 1000);
    await new Promise(requestAnimationFrame);
  }
  const frames = updates / ((performance.now() - begun) / 1000);
  for (const {canvas} of strips) canvas.remove();
  const react = [];
  const Plotly = await load();
  const box = document.body.appendChild(document.createElement('div'));
  const figure = () => [
    names.map((name, i) => ({
      type: 'scatter',
      mode: 'lines',
      ...points(samples, name, samples.now - 100, samples.now),
      yaxis: `y${(Math.floor(i / 3) || '') && Math.floor(i / 3) + 1}`,
    })),
    {width: 700, height: 720, grid: {rows: 4, columns: 1}, yaxis2: {}, yaxis3: {}, yaxis4: {}},
  ];
  await Plotly.newPlot(box, ...figure());
  for (let k = 0; k < 7; k += 1) {
    push(rows(33));
    const began = performance.now();
    await Plotly.react(box, ...figure());
    react.push((performance.now() - began) / 1000);
  }
  Plotly.purge(box);
  box.remove();
  return {own, react, frames};
};
