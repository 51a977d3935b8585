// The picture of the plant: inputs, fault sites, outputs, observers. A fault site can be clicked.

import {fill} from '../../../common/dom.js';
import {badges, called} from '../../../common/names.js';
import {HALF, layout, WIDTH} from './diagram.js';
import {atLimit, controllers} from './loop-picture.js';
import {setPoints} from './set-points.js';
import {open} from '../dialogs/open-dialog.js';
import {asOfNow, heading, link, steady} from '../../../widgets/controls.js';
import {letters, s} from '../../../widgets/svg.js';
import {visible} from '../../state/visible.js';
import {named, t} from '../../../i18n/words.js';

/** @import {Plant} from '../../../pages/types.js' */
/** @import {App} from '../../types.js' */
/** @import {Box, Layout, Spot} from './diagram.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  /** @type {Value[]} */
  let values = [];
  /** @type {Limited[]} */
  let limits = [];
  /** @type {() => void} ends the subscriptions of the set points */
  let end = () => {};
  /** @type {Map<string, Drawn>} */
  let sites = new Map();
  const tag = asOfNow(app);
  const draw = () => {
    const {plant} = app.state;
    fill(
      element,
      heading(t('page.plant.title'), tag, plant && link(t('page.plant.equations'), () => open('equations'))),
      plant && picture(plant),
      plant && points(plant),
    );
    light();
  };
  /** @param {Plant} plant */
  const picture = (plant) => {
    const drawing = drawPlant(plant, app);
    ({values, sites, limits} = drawing);
    tick();
    return drawing.svg;
  };
  /** @param {Plant} plant */
  const points = (plant) => {
    end();
    const rows = setPoints(plant, app);
    ({end} = rows);
    return rows.elements;
  };
  /**
   * Amber: a fault acts there; a vermilion ring: an alarm names it, dashed where others explain the data equally
   * well.
   */
  const light = () => {
    const {faults, alarms} = visible(app.state);
    const active = new Set(faults.filter((fault) => fault.active).map((fault) => fault.subject));
    const on = alarms.filter((alarm) => alarm.over === null);
    const asked = new Set(app.state.lesson?.sites);
    for (const [subject, {group, title, onChannel, name}] of sites) {
      const mine = on.filter((alarm) =>
        onChannel ? alarm.subjects.includes(subject) : !alarm.explained && alarm.subject === subject,
      );
      const sure = mine.some((alarm) => alarm.subjects.length < 2);
      group.classList.toggle('on', active.has(subject));
      group.classList.toggle('asked', asked.has(subject));
      group.classList.toggle('found', sure);
      group.classList.toggle('perhaps', mine.length > 0 && !sure);
      const said = [
        asked.has(subject) ? name : title,
        active.has(subject) && t('page.plant.site.active'),
        mine.length > 0 && (sure ? t('page.plant.site.identified') : t('page.plant.site.possible')),
      ];
      group.setAttribute('aria-label', said.filter(Boolean).join(', '));
    }
  };
  const tick = () => {
    for (const {column, node, scale} of values) {
      const now = app.latest(column);
      node.textContent = Number.isFinite(now) ? steady(now, Math.max(Math.abs(now), scale), 3) : '';
    }
    const full = limits.filter((one) => atLimit(one, app.latest(one.column)));
    for (const {mark, label} of limits) {
      mark.classList.toggle('on', full.length > 0);
      label.textContent = full.length ? t('page.plant.at-limit') : t('page.plant.saturation');
    }
  };
  app.subscribe((state) => [state.plant, state.language], draw);
  app.subscribe((state) => state.observers.map((one) => one.colour).join(), draw);
  app.subscribe((state) => [state.faults, state.alarms, state.lesson], light);
  app.subscribe(
    (state) => state.site,
    (site) => {
      for (const [subject, {group}] of sites) group.setAttribute('aria-pressed', String(subject === site));
    },
  );
  app.onTick(tick);
}

/** @param {Plant} plant @param {App} app */
export function drawPlant(plant, app) {
  const place = layout(plant);
  const short = badges(plant.channels);
  /** @type {Map<string, Drawn>} */
  const sites = new Map();
  /** @type {Value[]} */
  const values = [];
  const loop = place.loop && controllers(place, place.loop, plant, app);
  const parts = place.blocks.map((box) => block(box, plant));
  const buttons = place.blocks.flatMap((box) => box.spots.map((spot) => button(spot, short, app, sites)));
  const svg = s(
    'svg',
    {
      class: 'plant',
      viewBox: `0 0 ${WIDTH} ${place.height}`,
      role: 'group',
      'aria-label': t('page.plant.picture', {title: named(plant.title)}),
    },
    s(
      'defs',
      {},
      s(
        'marker',
        {id: 'tip', viewBox: '0 0 8 8', refX: 7, refY: 4, markerWidth: 6, markerHeight: 6, orient: 'auto'},
        s('path', {d: 'M0 0L8 4L0 8z', fill: 'var(--ink)'}),
      ),
    ),
    wires(place, plant, values, named),
    loop?.parts ?? [],
    parts,
    watchers(place, app),
    buttons,
  );
  return {svg, values, sites, limits: loop?.limits ?? []};
}

/** @typedef {{column: string, node: SVGElement, scale: number}} Value   a present value beside its wire */
/** @typedef {{group: SVGElement, title: string, name: string, onChannel: boolean}} Drawn   a fault site */
/** @typedef {{column: string, low: number, high: number, mark: SVGElement, label: SVGElement}} Limited   an input */
/** @typedef {{name: string, unit: string, description: string, default?: number}} Port */

/**
 * Signal lines: through the blocks, and down to the observers; with the present values of u and y beside these.
 * @param {Layout} place
 * @param {Plant} plant
 * @param {Value[]} values
 * @param {(words: string) => string} named
 */
function wires({blocks, axis, foot, left, right, loop}, plant, values, named) {
  /** @param {string} d */
  const wire = (d) => s('path', {class: 'wire', d, 'marker-end': 'url(#tip)'});
  const between = blocks
    .slice(1)
    .map((box, place) => wire(`M${blocks[place].x + blocks[place].width} ${axis}H${box.x - 1}`));
  const out = wire(`M${right} ${axis + HALF}V${foot}H${WIDTH / 2 + 56}`);
  const parts = [...between, out, ...list(plant.outputs, 'y.', right - 7, foot, 'end', values, named)];
  if (blocks[0].id === 'actuator') {
    const x = 13;
    const controlled = new Set(plant.controllers?.flatMap(({outputs}) => outputs.map(({input}) => input)));
    if (plant.inputs.some(({name}) => !controlled.has(name)))
      parts.push(wire(`M2 ${axis}H${left - 1}`), s('circle', {cx: x, cy: axis, r: 1.8, class: 'knot'}));
    parts.push(
      wire(`M${x} ${loop ? loop.y : axis}V${foot}H${WIDTH / 2 - 56}`),
      // above the set points, beside which they have no room
      ...list(plant.inputs, 'u.', x + 7, foot - 14 * (plant.references?.length ?? 0), 'start', values, named),
      ...list(plant.references ?? [], 'r.', WIDTH / 2 - 5, foot, 'end', values, named),
    );
    if (plant.inputs.length > 1)
      parts.push(
        s('path', {class: 'wire', d: `M5 ${axis + 5}l5 -10`}),
        s('text', {class: 'ts', x: 9, y: axis - 8}, String(plant.inputs.length)),
      );
  }
  return parts;
}

/**
 * Names and present values, one under the other beside a wire.
 * @param {Port[]} ports
 * @param {string} prefix
 * @param {number} x
 * @param {number} foot
 * @param {string} anchor
 * @param {Value[]} values
 * @param {(words: string) => string} named
 */
function list(ports, prefix, x, foot, anchor, values, named) {
  const top = foot - 22 - 14 * ports.length + 6;
  return ports.map((port, place) => {
    const node = s('tspan', {class: 'num'});
    values.push({column: prefix + port.name, node, scale: Math.abs(port.default ?? 0)});
    return s(
      'text',
      {class: 'port', x, y: top + place * 14, 'text-anchor': anchor},
      s('title', {}, [named(port.description), port.unit].filter(Boolean).join(', ')),
      letters(port.name, 13),
      ' ',
      node,
    );
  });
}

/** @param {Box} box @param {Plant} plant */
function block(box, plant) {
  const x = box.x + box.width / 2;
  const y = box.y + box.height / 2 + (box.sites.some((site) => site.onChannel) ? 5 : 0); // clear of the sites
  const frame = s('rect', {class: 'blk', x: box.x, y: box.y, width: box.width, height: box.height, rx: 6});
  if (box.id === 'hysteresis') {
    const loop = `M${x - 13} ${y + 14}h7c5 0 4 -26 13 -26h6M${x + 13} ${y - 12}h-7c-5 0 -4 26 -13 26`;
    return [frame, s('path', {class: 'hysteresis', d: loop}), s('title', {}, t('page.plant.block.hysteresis'))];
  }
  const discrete = plant.time.kind === 'discrete' && box.id === 'plant';
  const states = box.states.length ? summary(box.states, box.width) : [];
  const lift = (states.length ? 6 : -4) + (discrete ? 4 : 0);
  return [
    frame,
    s('text', {class: box.width < 52 ? 't small' : 't', x, y: y - lift}, t(`page.plant.block.${box.id}`)),
    states.length && s('text', {class: 'ts', x, y: y - lift + 14}, states),
    plant.time.kind === 'discrete' &&
      discrete &&
      s('text', {class: 'ts', x, y: y - lift + 26}, t('page.plant.every', {s: plant.time.period})),
  ].filter(Boolean);
}

/**
 * The states of a block, as many as fit.
 * @param {string[]} names
 * @param {number} width
 */
function summary(names, width) {
  const wide = names.reduce((sum, name) => sum + (name.length > 3 ? 6 * name.length : 15), 0);
  if (wide > width - 6) return [t('page.plant.states', {n: names.length})];
  return names.flatMap((name) => [...letters(name, 12), ' ']);
}

/**
 * A letter with its hat so much higher than a font puts it.
 * @param {string} letter
 * @param {number} up
 */
const hat = (letter, up) => [
  s('tspan', {class: 'letter'}, letter),
  s('tspan', {class: 'letter', dx: -5, dy: -up}, 'ˆ'),
  s('tspan', {dx: 1, dy: up}, '\u200b'),
];

/**
 * The observers below: they see u and y only. One stroke of colour each.
 * @param {Layout} place
 * @param {App} app
 */
function watchers({foot, axis}, app) {
  const {observers, plant} = app.state;
  const w = 112;
  const x = (WIDTH - w) / 2;
  const step = Math.min(16, (w - 16) / Math.max(observers.length, 1));
  const begin = WIDTH / 2 - (step * observers.length) / 2;
  const sees = t('page.plant.from');
  return [
    s('rect', {
      class: 'blk eye',
      x,
      y: foot - 23,
      width: w,
      height: 46,
      rx: 6,
      style: observers[0] && `stroke:${observers[0].colour}`,
    }),
    s('text', {class: 't', x: WIDTH / 2, y: foot - 9}, t('page.plant.observers')),
    s(
      'text',
      {class: 'ts', x: WIDTH / 2, y: foot + 6.5},
      ...hat('x', 0.6),
      ', ',
      ...hat('θ', 3.1),
      ' ',
      sees,
      s('tspan', {class: 'letter'}, plant?.inputs.length ? ' u, y' : ' y'),
    ),
    ...observers.map((one, place) =>
      s('rect', {
        x: begin + place * step + 1.5,
        y: foot + 13,
        width: step - 3,
        height: 3.5,
        rx: 1.5,
        style: `fill:${one.colour}`,
      }),
    ),
  ];
}

/**
 * One fault site: round for a channel, a small square for a measurement.
 * @param {Spot} spot
 * @param {Map<string, [string, string]>} short
 * @param {App} app
 * @param {Map<string, Drawn>} sites
 */
function button(spot, short, app, sites) {
  const press = () => {
    app.act.site(null);
    app.act.site(spot.subject);
  };
  const title = spot.onChannel
    ? t('page.plant.site', {title: named(spot.title)})
    : t('page.plant.site-output', {name: called(spot.name, app.state.plant)});
  /** @param {KeyboardEvent} event */
  const key = (event) => {
    if (event.key === 'Enter' || event.key === ' ') {
      event.preventDefault();
      press();
    }
  };
  const [base, index] = short.get(spot.name) ?? ['', ''];
  const long = base.length + index.length > 2;
  const group = s(
    'g',
    {
      class: `site${spot.onChannel ? '' : ' output'}`,
      role: 'button',
      tabindex: 0,
      'aria-label': title,
      'aria-pressed': 'false',
      transform: `translate(${spot.x.toFixed(1)} ${spot.y.toFixed(1)})`,
      onclick: press,
      onkeydown: key,
    },
    s('title', {}, title),
    spot.onChannel
      ? s('circle', {r: 11.4, class: 'ring'})
      : s('rect', {class: 'ring', x: -7, y: -7, width: 14, height: 14, rx: 2.5, transform: 'rotate(45)'}),
    spot.onChannel
      ? [
          s('circle', {r: 14, class: 'hit'}),
          s('circle', {r: 10}),
          s(
            'text',
            {y: 4, 'font-size': long ? 10 : 12},
            s('tspan', {}, base),
            index && s('tspan', {dy: 2.5, 'font-size': long ? 7 : 8.5}, index),
          ),
        ]
      : [
          s('circle', {r: 9, class: 'hit'}),
          s('rect', {x: -4.5, y: -4.5, width: 9, height: 9, rx: 1.5, transform: 'rotate(45)'}),
        ],
  );
  sites.set(spot.subject, {group, title, name: named(spot.title), onChannel: spot.onChannel});
  return group;
}
