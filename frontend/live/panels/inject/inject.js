// Inject a fault: a row for every channel, one for every output's measurement, the noise, and the error of the model.

import {childrenOf, fill, h, query} from '../../../common/dom.js';
import {badges, called, split} from '../../../common/names.js';
import {createRow} from './inject-row.js';
import {wholeLines} from '../../../widgets/whole-lines.js';
import {asOfNow, badge, heading, link, slider, throttled} from '../../../widgets/controls.js';
import {linear, logarithmic} from '../../../widgets/slider-scale.js';
import {named, t} from '../../../i18n/words.js';

/** @import {Plant} from '../../../pages/types.js' */
/** @import {App, Output} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {InjectRow} from './inject-row.js' */
/** @import {Subject} from './fault-form.js' */

/**
 * In place of faults that could be injected: where the readings come from.
 * @param {service.RecordedTruth} record
 */
const recordNote = ({id, name}) => [
  h('p', {}, t('page.inject.record.replayed', {name: name || id.slice(0, 8)})),
  h('p', {class: 'soft'}, t('page.inject.record.hint')),
  h('a', {class: 'link', href: `/records/?record=${encodeURIComponent(id)}`}, t('page.inject.record.open')),
];

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  /** @type {Map<string, InjectRow>} */
  let rows = new Map();
  let open = false; // the rows of measurement faults
  /** @type {Plant | null} whose rows these are */
  let shown = null;
  /** @type {(() => void)[]} of subscriptions that the rows hold */
  const ends = [];
  /** @type {(open: boolean) => void} shows the rows of measurement faults, or hides them */
  let showOutputs = () => {};
  const list = h('div', {class: 'scroll faults'});
  const more = wholeLines(list, () => childrenOf(list), app);
  const tag = asOfNow(app);

  /** Show nothing of the last plant while the shapes of faults are awaited. */
  const clear = () => {
    rows = new Map();
    for (const end of ends.splice(0)) end();
    fill(list);
  };
  const build = async () => {
    const {plant} = app.state;
    if (plant !== shown) clear();
    shown = plant;
    const {faults} = await app.catalogue;
    if (plant !== app.state.plant) return;
    clear();
    if (!plant) return fill(element, heading(t('page.inject.title')));
    const record = app.state.spec?.truth?.record;
    if (record) return fill(element, heading(t('page.inject.record')), recordNote(record));
    const channels = channelRows(app, plant, faults, rows);
    const outputs = outputRows(app, plant, faults, rows);
    const toggle = link(
      t('page.inject.more-faults'),
      () => {
        show(!open);
        if (open) outputs[0]?.element.scrollIntoView({block: 'nearest'});
        if (open) list.scrollTop = Math.max(list.scrollTop, list.scrollHeight - list.clientHeight);
      },
      {'aria-expanded': 'false'},
    );
    /** @param {boolean} now */
    const show = (now) => {
      open = now;
      toggle.setAttribute('aria-expanded', String(open));
      toggle.textContent = open ? t('page.inject.fewer-faults') : t('page.inject.more-faults');
      for (const {element: row, active} of outputs) row.hidden = !open && !active;
    };
    fill(
      list,
      channels.map((row) => row.element),
      plant.channels.length === 0 && h('p', {class: 'soft'}, t('page.inject.no-channels')),
      plant.outputs.map((output, place) => [outputs[place].element, noiseRow(app, output, ends)]),
      plant.parameters.length > 0 && modelRow(app, ends),
    );
    fill(element, heading(t('page.inject.title'), tag, toggle), list, more);
    showOutputs = show;
    show(open);
    return update();
  };
  const update = () => {
    const {role, spec} = app.state;
    for (const [subject, row] of rows)
      row.show(
        app.state.faults.filter((fault) => fault.subject === subject && !fault.ended),
        role,
        spec?.horizon,
      );
    showOutputs(open);
  };
  /** @param {string | null} site */
  const choose = (site) => {
    const row = site === null ? undefined : rows.get(site);
    if (!row) return;
    if (!app.state.plant?.channels.some((channel) => channel.name === site)) showOutputs(true);
    for (const {element: one} of rows.values()) one.classList.toggle('chosen', one === row.element);
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    row.element.scrollIntoView({block: 'nearest', behavior: still ? 'auto' : 'smooth'});
    (row.main?.range ?? query('select', row.element)).focus({preventScroll: true});
  };
  app.subscribe((state) => [state.plant, state.language, state.session], build);
  app.subscribe((state) => [state.faults, state.role], update);
  app.subscribe(
    (state) => state.site,
    (site) => choose(site),
  );
}

/**
 * @param {App} app
 * @param {Plant} plant
 * @param {service.FaultForm[]} shapes
 * @param {Map<string, InjectRow>} rows
 */
function channelRows(app, plant, shapes, rows) {
  const short = badges(plant.channels);
  const mine = shapes.filter((shape) => shape.on === 'channel');
  return plant.channels.map((channel) => {
    const subject = {
      name: channel.name,
      onChannel: true,
      typical: channel.typical,
      bounds: channel.bounds,
      unit: channel.unit,
      level: 0,
      ...times(app),
    };
    const row = createRow(app, () => subject, {
      title: titled(named(channel.title) || channel.name),
      description: named(channel.description),
      kind: t(`page.fault.kind.${channel.kind}`),
      badge: short.get(channel.name) ?? split(channel.name),
      shapes: mine,
    });
    rows.set(channel.name, row);
    return row;
  });
}

/**
 * @param {App} app
 * @param {Plant} plant
 * @param {service.FaultForm[]} shapes
 * @param {Map<string, InjectRow>} rows
 */
function outputRows(app, plant, shapes, rows) {
  const mine = shapes.filter((shape) => shape.on === 'output');
  return plant.outputs.map((output) => {
    /** @returns {Subject} */
    const subject = () => ({
      name: output.name,
      onChannel: false,
      bounds: [null, null],
      unit: output.unit,
      ...size(app, output.name),
      ...times(app),
    });
    const row = createRow(app, subject, {
      title: titled(named(output.description) || output.name),
      description: '',
      kind: t('page.fault.kind.measurement'),
      badge: split(output.name),
      shapes: mine,
    });
    rows.set(output.name, row);
    return row;
  });
}

/** @param {string} words */
const titled = (words) => words && words[0].toUpperCase() + words.slice(1);

/**
 * The times that the first values depend on.
 * @param {App} app
 */
function times(app) {
  const {spec, noise, step} = app.state;
  const held = Object.values(noise)[0]?.sample_time;
  const measurement = spec?.measurement;
  const period = measurement && 'period' in measurement ? measurement.period : undefined;
  return {horizon: spec?.horizon ?? 100, sampleTime: period ?? held ?? 10 * step};
}

/**
 * The present size of an output, and the size of a visible fault on it: a third of its recent range, at least a tenth
 * of its value.
 * @param {App} app
 * @param {string} name
 */
function size(app, name) {
  const {min, max} = app.range(`y.${name}`, Math.max(0, app.state.t - 60), app.state.t);
  const now = app.latest(`y.${name}`);
  const level = Number.isFinite(now) ? now : 0;
  const swing = Number.isFinite(max - min) ? max - min : 0;
  return {level, typical: Math.max(swing / 3, Math.abs(level) / 10) || 1};
}

/**
 * The measurement noise of one output: its standard deviation, moved while time runs.
 * @param {App} app
 * @param {Output} output
 * @param {(() => void)[]} ends
 */
function noiseRow(app, output, ends) {
  const noise = () => app.state.noise[output.name] ?? {std: 0, sample_time: times(app).sampleTime};
  const begin = noise().std || size(app, output.name).typical / 30 || 0.01;
  const send = throttled(async (/** @type {number} */ std) => {
    try {
      await app.send({type: 'set-noise', output: output.name, std, sample_time: noise().sample_time});
    } catch (error) {
      app.act.refused(error);
      control.show(noise().std);
    }
  });
  const control = slider({
    name: t('page.inject.noise-of', {name: called(output.name, app.state.plant)}),
    scale: logarithmic(begin / 30, begin * 30, true),
    value: noise().std,
    low: 0,
    change: (std) => send(std),
  });
  ends.push(
    app.subscribe(
      (state) => [state.noise[output.name]?.std ?? 0, state.role],
      ([std, role]) => {
        control.follow(std);
        control.disable(role === 'view');
      },
    ),
  );
  const hint = [t('page.inject.noise-held', {s: String(noise().sample_time)}), output.unit].filter(Boolean).join(', ');
  return h(
    'div',
    {
      class: 'fault noise',
      role: 'group',
      'aria-label': t('page.inject.noise-of', {name: called(output.name, app.state.plant)}),
      title: hint,
    },
    badge(split(output.name), {square: true}),
    h(
      'div',
      {class: 'control'},
      h('span', {}, t('page.inject.noise'), ' ', h('i', {}, 'σ')),
      control.range,
      control.field,
    ),
  );
}

const MOST_OFF = 50; // per cent

/**
 * The share by which the parameters of the plant differ from the model that observers know, moved while time runs.
 * @param {App} app
 * @param {(() => void)[]} ends
 */
function modelRow(app, ends) {
  /** @returns {Partial<service.Truth>} */
  const truth = () => app.state.facts?.truth ?? {};
  const percent = () => 100 * (truth().deviation ?? 0);
  const send = throttled(async (/** @type {number} */ value) => {
    try {
      await app.send({type: 'set-truth', truth: {...truth(), deviation: value / 100}});
    } catch (error) {
      app.act.refused(error);
      control.show(percent());
    }
  });
  const control = slider({
    name: t('page.inject.model-of'),
    scale: linear(0, 10),
    value: percent(),
    low: 0,
    high: MOST_OFF,
    change: (value) => send(value),
  });
  ends.push(
    app.subscribe(
      (state) => [state.facts?.truth?.deviation ?? 0, state.role],
      ([deviation, role]) => {
        control.follow(100 * deviation);
        control.disable(role === 'view');
      },
    ),
  );
  return h(
    'div',
    {
      class: 'fault model',
      role: 'group',
      'aria-label': t('page.inject.model-of'),
      title: t('page.inject.model-hint'),
    },
    badge(split('p'), {square: true}),
    h(
      'div',
      {class: 'control'},
      h('span', {}, t('page.inject.model')),
      control.range,
      control.field,
      h('span', {}, '%'),
    ),
  );
}
