// Texts to begin with: a tank, a motor, and an empty plant.

import {t} from '../../i18n/words.js';

/** @type {{[name: string]: () => string}} */
export const TEMPLATES = {
  tank: () => `id: my-tank
title: ${t('page.workshop.template.tank')}
states:
  - {name: h, unit: cm, initial: 20, domain: [0, 60]}
inputs:
  - {name: q, unit: cm³/s, default: 50, bounds: [0, 150]}
outputs:
  - {name: y, unit: cm, expression: h}
  - {name: w, unit: cm³/s, expression: out}
parameters:
  - {name: A, value: 154, unit: cm², bounds: [1, null]}
  - {name: a, value: 0.25, unit: cm², bounds: [0, null]}
  - {name: g, value: 981, unit: cm/s²}
definitions:
  - {name: out, expression: "a*sqrt(2*g*max(h, 0))"}
dynamics:
  h: (q - out)/A
channels:
  - name: pump
    title: ${t('page.workshop.template.pump')}
    kind: actuator
    enters: {h: -q/A}
    typical: 0.1
    bounds: [0, 1]
  - name: leak
    title: ${t('page.workshop.template.leak')}
    kind: process
    enters: {h: "-sqrt(2*g*max(h, 0))/A"}
    unit: cm²
    typical: 0.02
    bounds: [0, 0.5]
  - name: offset
    title: ${t('page.workshop.template.offset')}
    kind: sensor
    enters: {y: 1}
    unit: cm
    typical: 1
`,
  motor: () => `id: my-motor
title: ${t('page.workshop.template.motor')}
states:
  - {name: i, unit: A, initial: 1}
  - {name: w, unit: rad/s, initial: 100}
inputs:
  - {name: u, unit: V, default: 12, bounds: [0, 24]}
outputs:
  - {name: y_i, unit: A, expression: i}
  - {name: y_w, unit: rad/s, expression: w}
parameters:
  - {name: R, value: 1, unit: Ω, bounds: [0.01, null]}
  - {name: L, value: 0.01, unit: H, bounds: [0.0001, null]}
  - {name: k, value: 0.1, unit: V·s/rad, bounds: [0, null]}
  - {name: J, value: 0.001, unit: kg·m², bounds: [0.00001, null]}
  - {name: d, value: 0.001, unit: N·m·s, bounds: [0, null]}
dynamics:
  i: (u - R*i - k*w)/L
  w: (k*i - d*w)/J
channels:
  - name: supply
    title: ${t('page.workshop.template.supply')}
    kind: actuator
    enters: {i: -u/L}
    typical: 0.1
    bounds: [0, 1]
  - name: load
    title: ${t('page.workshop.template.load')}
    kind: process
    enters: {w: -1/J}
    unit: N·m
    typical: 0.02
`,
  empty: () => `id: my-plant
title: ${t('page.workshop.template.empty')}
states:
  - {name: x, initial: 0}
inputs:
  - {name: u, default: 1}
outputs:
  - {name: y, expression: x}
dynamics:
  x: u - x
channels: []
`,
};
