// The preview: inputs and outputs over time, healthy and with one fault of usual size.

import {h, number, symbol} from '../../../common/dom.js';
import {s} from '../../../widgets/svg.js';
import {named, t} from '../../../i18n/words.js';
import {inputMenus} from './preview-inputs.js';

/** @import * as service from '../../../types/service.js' */
/** @import {ShopState, ShopStore} from '../types.js' */

const WIDTH = 250;
const HEIGHT = 52;
const INPUTS = 2; // that are shown
const MOST = 5; // strips; a plant with more outputs shows the first

let shown = ''; // the channel that is shown; kept while the text changes

/** @param {ShopState} state @param {ShopStore} store */
export function drawPreview(state, store) {
  if (state.trialProblem) return h('p', {class: 'note'}, state.trialProblem.detail || state.trialProblem.title);
  if (!state.trial || !state.good?.plant) return h('p', {class: 'soft busy'}, t('page.workshop.simulating'));
  const {preview} = state.trial;
  const {plant} = state.good;
  const channels = plant.channels.filter((one) => one.name in preview.faulty);
  if (!channels.some((one) => one.name === shown)) shown = channels[0]?.name ?? '';
  const box = h('div', {class: 'preview'});
  const menus = inputMenus(state, store, Object.keys(preview.inputs).slice(0, INPUTS));
  const draw = () =>
    box.replaceChildren(h('p', {class: 'preview-choice'}, menus), ...parts(preview, plant, draw, channels));
  draw();
  return box;
}

/**
 * @param {service.PlantPreview} preview
 * @param {service.Plant} plant
 * @param {() => void} again
 * @param {readonly service.Channel[]} channels
 */
function parts(preview, plant, again, channels) {
  const end = preview.t.at(-1) ?? 1;
  const faulty = preview.faulty[shown] ?? {};
  const inputs = Object.entries(preview.inputs).slice(0, INPUTS);
  const outputs = Object.entries(preview.outputs).slice(0, MOST - inputs.length);
  /** @param {string} name */
  const unit = (name) => [...plant.inputs, ...plant.outputs].find((one) => one.name === name)?.unit ?? '';
  const strips = [
    ...inputs.map(([name, values]) => strip(name, unit(name), preview.t, [[values, 'input']], end)),
    ...outputs.map(([name, values]) =>
      strip(
        name,
        unit(name),
        preview.t,
        [[values, 'healthy'], ...(faulty[name] ? [/** @type {[number[], string]} */ ([faulty[name], 'faulty'])] : [])],
        end,
      ),
    ),
  ];
  const choose = h(
    'select',
    {
      'aria-label': t('page.workshop.preview.fault'),
      onchange: ({currentTarget: {value}}) => {
        shown = value;
        again();
      },
    },
    channels.map((one) => h('option', {value: one.name, selected: one.name === shown}, named(one.title) || one.name)),
  );
  const axis = h(
    'div',
    {class: 'preview-axis'},
    h('span', {}, '0 s'),
    h('span', {}, number(end / 2, 3)),
    h('span', {}, `${number(end, 3)} s`),
  );
  const legend = h(
    'p',
    {class: 'preview-legend'},
    h('span', {class: 'swatch healthy'}),
    t('page.workshop.preview.healthy'),
    channels.length > 0 && [
      h('span', {class: 'swatch faulty'}),
      t('page.workshop.preview.with'),
      ' ',
      channels.length > 1 ? choose : symbol(shown),
      ` = ${number(preview.sizes[shown], 3)}`,
      ' ',
      t('page.workshop.preview.from', {t: number(preview.onset, 3)}),
    ],
  );
  return [...strips, axis, legend];
}

/**
 * @param {string} name
 * @param {string} unit
 * @param {readonly number[]} t
 * @param {[readonly number[], string][]} curves
 * @param {number} end
 */
function strip(name, unit, t, curves, end) {
  const all = curves.flatMap(([values]) => values);
  let [low, high] = [Math.min(...all), Math.max(...all)];
  if (!(high > low)) [low, high] = [low - Math.max(1, Math.abs(low)) * 0.1, high + Math.max(1, Math.abs(high)) * 0.1];
  const x = (/** @type {number} */ at) => ((at / (end || 1)) * WIDTH).toFixed(1);
  const y = (/** @type {number} */ value) => (HEIGHT - 5 - ((value - low) / (high - low)) * (HEIGHT - 10)).toFixed(1);
  const picture = s(
    'svg',
    {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', 'aria-hidden': 'true'},
    s('rect', {x: 0, y: 0, width: WIDTH, height: HEIGHT, class: 'frame'}),
    [0.25, 0.5, 0.75].map((share) => s('path', {class: 'grid', d: `M${WIDTH * share} 0V${HEIGHT}`})),
    curves.map(([values, kind]) =>
      s('path', {
        class: `curve ${kind}`,
        d: values.map((value, row) => `${row ? 'L' : 'M'}${x(t[row])} ${y(value)}`).join(''),
      }),
    ),
  );
  return h(
    'div',
    {class: 'preview-strip', title: unit && `${name}, ${unit}`},
    symbol(name),
    h('span', {class: 'tick-values'}, h('span', {}, number(high, 3)), h('span', {}, number(low, 3))),
    picture,
  );
}
