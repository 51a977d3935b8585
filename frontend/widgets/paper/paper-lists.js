// The curves and panels of "Figure for a paper": boxes to tick, and the line style of each curve.

import {fill, h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';
import {choice} from './paper-fields.js';

/** @import * as service from '../../types/service.js' */
/** @import {Settings} from './paper-fields.js' */

/**
 * The lists, and the function that shows another description in them; fields keep the focus while names stay.
 * @param {(changes: Partial<Settings>) => void} set
 * @param {Settings} settings
 */
export function curvesAndPanels(set, settings) {
  const root = h('div', {class: 'lists'});
  /** @type {service.PrintedFigure | null} */
  let latest = null;
  let names = '';
  /** @type {Map<string | number, HTMLInputElement>} */
  const boxes = new Map();
  /** @type {Map<string, HTMLSelectElement>} */
  const styles = new Map();

  /** @param {string} label @param {string | number} key @param {() => void} act */
  function check(label, key, act) {
    const box = h('input', {type: 'checkbox', onchange: act});
    boxes.set(key, box);
    return h('label', {}, box, label);
  }

  /**
   * The ticked ones of a list; none for all of them.
   * @template {string | number} Key
   * @param {Key[]} keys
   */
  function ticked(keys) {
    const shown = keys.filter((key) => boxes.get(key)?.checked);
    return shown.length === keys.length ? [] : shown;
  }
  const setCurves = () => set({curves: ticked((latest?.curves ?? []).map(({key}) => key))});
  const setPanels = () => set({panels: ticked((latest?.panels ?? []).map(({number}) => number))});

  /** @param {service.PrintedFigure} described */
  function build(described) {
    boxes.clear();
    styles.clear();
    const entries = described.styles.map((name) => [name, t(`page.paper.style.${name}`)]);
    const rows = described.curves.map(({key, label, style}) => {
      const select = choice(t('page.paper.style-of', {curve: label}), entries, style, (chosen) =>
        set({styles: {...settings.styles, [key]: chosen}}),
      );
      styles.set(key, select);
      return h('div', {class: 'curve'}, check(label, key, setCurves), select);
    });
    const panels = described.panels.map(({number, label}) => check(label, number, setPanels));
    fill(
      root,
      rows.length > 0 && h('fieldset', {}, h('legend', {}, t('page.paper.curves')), rows),
      panels.length > 1 && h('fieldset', {class: 'panels'}, h('legend', {}, t('page.paper.panels')), panels),
    );
  }

  /** @param {service.PrintedFigure} described */
  function show(described) {
    latest = described;
    const {curves, panels} = described;
    const now = JSON.stringify([curves.map(({key, label}) => [key, label]), panels.map(({label}) => label)]);
    if (now !== names) build(described);
    names = now;
    for (const {key, style, drawn} of curves) {
      const [box, select] = [boxes.get(key), styles.get(key)];
      if (box) box.checked = drawn;
      if (select) select.value = style;
    }
    for (const {number, drawn} of panels) {
      const box = boxes.get(number);
      if (box) box.checked = drawn;
    }
  }
  return {root, show};
}
