// The table that compares the observers over the window that the scope shows.

import {fill, h, hatted, symbol} from '../../dom.js';
import {finding} from '../alarms.js';
import {noise, rmse, settled} from './metrics.js';
import {chip, heading, steady, took} from './parts.js';
import {badges, called, plain, split, symbolic, titleOf} from './symbols.js';

const EVERY = 900; // ms between two computations
const LONGEST = 6000; // rows of a window of "all"
const MOST = 200_000; // rows after a fault that are looked at
const SETTLED = 0.1; // of the step: as in backend/diagnosis/metrics.py

export function mount(element, app) {
  let state = null; // chosen by hand
  let channel = null;
  let cells = [];
  let last = 0;
  let detector = null;
  const body = h('tbody');

  const build = () => {
    const {plant, observers} = app.state;
    element.hidden = !plant || observers.length === 0;
    if (element.hidden) return;
    const [x, theta] = chosen();
    const head = h('tr', {}, h('td'), h('th', {scope: 'col', title: app.text.rmseHint}, 'RMSE ', picker(plant.states, x, app.text.whichState, (name) => { state = name; build(); })),
      theta && h('th', {scope: 'col', title: app.text.settleHint}, app.text.settle, ' ', picker(plant.channels, theta, app.text.whichFault, (name) => { channel = name; build(); })),
      theta && h('th', {scope: 'col', title: app.text.noiseHint}, app.text.noiseShort, ' ', short(theta, plant.channels, true)));
    cells = observers.map((observer) => ({observer, row: [h('td'), ...(theta ? [h('td'), h('td')] : [])]}));
    detector = theta ? h('td') : null;
    fill(body, cells.map(({observer, row}) => h('tr', {}, h('th', {scope: 'row', title: observer.label}, chip(observer.colour), h('span', {class: 'said'}, observer.label)), row)),
      theta && app.state.diagnosis?.note === '' && h('tr', {class: 'detector', title: app.text.foundHint}, h('th', {scope: 'row', colspan: 2}, app.text.foundBy), detector, h('td')));
    fill(element, heading(app.text.comparison), h('div', {class: 'scroll'}, h('table', {}, h('caption', {class: 'said'}, app.text.comparison), h('thead', {}, head), body)));
    compute();
  };
  /** State and channel of the columns: chosen by hand, else the first state and the newest fault. */
  const chosen = () => {
    const {plant, faults, columns} = app.state;
    const estimated = plant.channels.filter((one) => columns.some((column) => column.endsWith(`.theta.${one.name}`) && !column.startsWith('theta.')));
    const newest = faults.findLast((fault) => fault.onChannel && fault.active && estimated.some((one) => one.name === fault.subject));
    const x = plant.states.some((one) => one.name === state) ? state : plant.states[0].name;
    return [x, plant.channels.some((one) => one.name === channel) ? channel : newest?.subject ?? estimated[0]?.name ?? null];
  };
  const compute = () => {
    const {plant, t, window, selection} = app.state;
    if (!plant || cells.length === 0) return;
    const [x, theta] = chosen();
    const [from, to] = selection ?? [Math.max(0, t - (window ?? LONGEST * app.state.record)), t];
    const truth = app.window(`x.${x}`, from, to);
    const fault = app.state.faults.findLast((one) => one.subject === theta && one.onset <= t);
    if (detector) put(detector, fault ? delay(fault) : '–');
    for (const {observer, row} of cells) {
      const mine = app.window(`${observer.label}.x.${x}`, from, to);
      put(row[0], mine.v.length === truth.v.length ? steady(rmse(mine.v, truth.v), undefined, 2) : '–');
      if (row.length === 1) continue;
      const estimate = app.window(`${observer.label}.theta.${theta}`, to - (to - from) / 4, to);
      put(row[1], fault ? settling(observer, theta, fault, t) : '–');
      put(row[2], steady(noise(estimate.t, estimate.v), undefined, 2));
    }
  };
  /** How soon the detector named it. */
  const delay = (fault) => {
    const found = finding(fault, app.state.alarms);
    return found === null ? app.text.notYet : found.delay === null ? '–' : took(found.delay);
  };
  const settling = (observer, theta, fault, t) => {
    if (fault.shape !== 'step') return '–';
    const {record, faults} = app.state;
    const from = fault.onset;
    const next = Math.min(...faults.flatMap(({onset, end}) => [onset, end ?? Infinity]).filter((event) => event > from)); // disturbs the estimate, too
    const until = Math.min(next - record / 2, t, from + MOST * record);
    const truth = app.window(`theta.${theta}`, from, until);
    const mine = app.window(`${observer.label}.theta.${theta}`, from, until);
    if (mine.v.length !== truth.v.length || mine.v.length < 3 || !mine.v.some(Number.isFinite)) return '–';
    const time = settled(truth.t, truth.v, mine.v, from, SETTLED * Math.abs(fault.fault.size));
    return time === null ? app.text.notYet : took(time);
  };
  app.subscribe((s) => [s.plant, s.language, s.observers, s.columns, s.diagnosis?.note], build);
  app.subscribe((s) => s.faults, build);
  app.onTick(() => {
    const now = performance.now();
    if (now - last < EVERY) return;
    last = now;
    compute();
  });
}

/** Set a cell; a number that has not changed is left alone. */
function put(cell, words) {
  if (cell.textContent !== words) cell.textContent = words;
}

/** A name that fits the head of a column: long ones as in the badges. */
function short(name, items, hat = false) {
  if (split(name)[0].length === 1) return symbol(name, hat);
  const [letters, index] = badges(items).get(name);
  return h('span', {class: 'math', title: plain(name)}, hat ? hatted(letters) : h('i', {}, letters), index && h('sub', {}, index));
}

/** Which state or channel a column is about. */
function picker(items, chosen, name, choose) {
  if (items.length < 2) return short(chosen, items);
  return h('span', {class: 'picker'}, short(chosen, items), h('select', {'aria-label': name, onchange: (event) => choose(event.target.value)},
    items.map((item) => h('option', {value: item.name, selected: item.name === chosen}, `${plain(item.name)}  ${item.title || item.description || ''}`))));
}
