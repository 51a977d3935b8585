// The inputs of the preview: a menu of shapes for each, in place of the square waves that the server proposes.

import {h, symbol} from '../../../common/dom.js';
import {begun} from '../../../widgets/signal/shapes.js';
import {t} from '../../../i18n/words.js';

/** @import {Signal} from '../../../widgets/signal/shapes.js' */
/** @import {ShopState, ShopStore} from '../types.js' */

const OFFERED = ['square', 'constant', 'sine', 'chirp', 'prbs', 'steps'];
const USUAL = 'square'; // the server's proposal

/**
 * A menu for each of some inputs.
 * @param {ShopState} state
 * @param {ShopStore} store
 * @param {readonly string[]} names
 */
export function inputMenus({trial, tried, good}, store, names) {
  const proposed = trial?.experiment.inputs ?? {};
  return names
    .filter((name) => name in proposed)
    .map((name) => {
      const menu = h(
        'select',
        {
          'aria-label': t('page.inputs.shape-of', {name}),
          onchange: ({currentTarget}) => {
            const {[name]: _, ...inputs} = store.state.tried.inputs;
            const signal = currentTarget.value === USUAL ? {} : {[name]: shaped(currentTarget.value)};
            store.set({tried: {...store.state.tried, inputs: {...inputs, ...signal}}});
          },
        },
        OFFERED.map((shape) => h('option', {value: shape}, t(`page.inputs.shape.${shape}`))),
      );
      menu.value = tried.inputs[name]?.kind ?? USUAL;
      return h('label', {class: 'preview-input'}, symbol(name), menu);

      /** @param {string} shape @returns {Signal} */
      function shaped(shape) {
        const values = trial?.preview.inputs[name] ?? [0, 1];
        const [least, most] = [Math.min(...values), Math.max(...values)];
        const bounds = good?.plant?.inputs.find((one) => one.name === name)?.bounds ?? [null, null];
        const span = most - least || 1;
        const room = {
          low: bounds[0] ?? least - span,
          high: bounds[1] ?? most + span,
          level: (least + most) / 2,
          step: trial?.experiment.step ?? 0.01,
          horizon: trial?.experiment.horizon ?? 10,
        };
        return begun(shape, proposed[name], room, 0);
      }
    });
}
