// The figures of a paper: what is printed, in words, and the figure that is computed here.

import {get, reason} from '../../../common/api.js';
import {fill, h} from '../../../common/dom.js';
import {named, t} from '../../../i18n/words.js';
import {openPaper} from '../../../widgets/paper/paper-dialog.js';
import {withSymbols} from '../../../widgets/prose.js';
import {drawFigure} from '../../runs/figures.js';
import {resultOf} from './results.js';

/** @import {FigureBox} from '../../types.js' */
/** @import {PlotlyFigure} from '../../../types/globals.js' */
/** @import * as service from '../../../types/service.js' */

/** @param {readonly service.PaperFigure[]} figures */
export const figureCards = (figures) =>
  figures.map((one) =>
    h(
      'article',
      {class: 'papers-figure'},
      h(
        'div',
        {},
        h('h3', {}, one.number),
        h('p', {}, h('b', {}, t('page.papers.printed')), ' ', withSymbols(named(one.printed))),
        one.ours && h('p', {}, h('b', {}, t('page.papers.ours')), ' ', withSymbols(named(one.ours))),
      ),
      computedFigure(one.experiment, one.figure),
    ),
  );

/** @type {Set<() => void>} */
const drawn = new Set();
addEventListener('theme', () => drawn.forEach((again) => again()));
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;
addEventListener('resize', () => {
  clearTimeout(timer);
  timer = setTimeout(() => drawn.forEach((again) => again()), 200);
});

/**
 * A figure of an experiment, computed and drawn when it comes near the screen.
 * @param {string} experiment
 * @param {string} name
 */
export function computedFigure(experiment, name) {
  const waits = h('p', {class: 'soft', role: 'status'}, t('page.papers.computing'));
  /** @type {FigureBox['plot']} */
  const plot = h('div', {class: 'plot', role: 'group', 'aria-label': name});
  const under = h('p', {class: 'papers-under'});
  const box = h('div', {class: 'papers-plot', 'data-figure': name}, waits, plot, under);

  async function draw() {
    try {
      const run = await resultOf(experiment);
      const address = `${run.links.figures}/${encodeURIComponent(name)}`;
      /** @type {PlotlyFigure} */
      const figure = await get(`${address}?theme=${window.theme.now}`);
      if (!box.isConnected) return drawn.delete(draw);
      const title = named(figure.layout.meta?.title);
      plot.setAttribute('aria-label', title);
      waits.remove();
      await drawFigure(plot, figure);
      box.dataset.drawn = '';
      fill(
        under,
        h('a', {href: `/runs/?run=${encodeURIComponent(run.id)}`}, t('page.papers.open-run')),
        h('button', {type: 'button', class: 'quiet', onclick: () => openPaper(address, title)}, t('page.paper.open')),
      );
      drawn.add(draw);
    } catch (error) {
      fill(waits, h('span', {class: 'alarm'}, reason(error).message));
    }
    return true;
  }
  const near = new IntersectionObserver(
    (entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      near.disconnect();
      draw();
    },
    {rootMargin: '400px'},
  );
  near.observe(box);
  return box;
}
