// The pointer over the strips: the time under it on all of them, and zooming by drag.

import {fill, h} from '../dom.js';
import {seconds} from './format.js';

const DRAG = 6; // px before it counts as one

export function mountPointer(plots, app, scope) {
  const line = h('div', {class: 'cursor', hidden: true}, h('span', {class: 'cursor-time'}));
  const area = h('div', {class: 'zoom-area', hidden: true});
  plots.append(line, area);
  let left = 0;
  let width = 1;
  let start = null; // x where the drag began
  let dragged = false;

  const inside = (event) => event.clientX - plots.getBoundingClientRect().left - left;
  const timeAt = (x) => {
    const [t0, t1] = scope.span();
    return t0 + (Math.min(width, Math.max(0, x)) / width) * (t1 - t0);
  };

  function show(x) {
    const over = x >= -2 && x <= width + 2;
    line.hidden = !over;
    app.cursor(over ? Math.max(0, Math.min(timeAt(x), app.samples.now)) : null);
    if (!over) return;
    const [t0, t1] = scope.span();
    line.style.transform = `translateX(${left + Math.min(width, Math.max(0, x))}px)`;
    fill(line.firstChild, `${seconds(timeAt(x), (t1 - t0) / 500)} s`);
  }

  function hide() {
    line.hidden = true;
    app.cursor(null);
  }

  plots.addEventListener('pointermove', (event) => {
    const x = inside(event);
    if (start === null) {
      show(x);
      return;
    }
    dragged ||= Math.abs(x - start) > DRAG;
    if (!dragged) return;
    const [a, b] = [Math.max(0, Math.min(x, start)), Math.min(width, Math.max(x, start))];
    area.hidden = false;
    Object.assign(area.style, {left: `${left + a}px`, width: `${b - a}px`});
    show(x);
  });
  plots.addEventListener('pointerdown', (event) => {
    const x = inside(event);
    if (event.button !== 0 || x < 0 || x > width || event.pointerType === 'touch') return;
    start = x;
    dragged = false;
    held = scope.span();
    plots.setPointerCapture(event.pointerId);
  });
  let held = [0, 1]; // the window when the drag began: it may have moved on since
  plots.addEventListener('pointerup', (event) => {
    if (start === null) return;
    const x = inside(event);
    const at = (place) => held[0] + (Math.min(width, Math.max(0, place)) / width) * (held[1] - held[0]);
    if (dragged) app.act.select(at(Math.min(x, start)), at(Math.max(x, start)));
    start = null;
    area.hidden = true;
  });
  plots.addEventListener('pointercancel', () => {
    start = null;
    area.hidden = true;
  });
  plots.addEventListener('pointerleave', () => start === null && hide());
  plots.addEventListener('dblclick', () => app.act.select(null));
  app.subscribe((state) => state.language, () => { plots.title = ''; });

  return {
    /** Where the plot areas begin, and how wide they are, in the list's own pixels. */
    measure(from, wide) {
      left = from;
      width = Math.max(1, wide);
    },
    /** The time under a resting pointer while the curves move on below it. */
    refresh() {
      if (!line.hidden && start === null) show(Number.parseFloat(line.style.transform.slice(11)) - left);
    },
  };
}
