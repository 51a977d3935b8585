// Which strips a session has and what each of them draws: one per fault channel, per set point and input of a loop, per
// state, per output's residual, per residual that is blind to one channel, and the excitation.

/** @import {DerivedColumn, FaultState, ObserverState, Plant, Sketched, State, Strip, Trace} from '../types.js' */

const MOST_STATES = 4;
const MOST_CHANNELS = 6;
const BAND = 2; // standard deviations on either side

/** @typedef {{column: string, low?: string, high?: string}} Columns */
/** @typedef {(make: (observer: ObserverState) => Columns) => Trace[]} MakeTraces */
/** @typedef {Omit<Strip, 'shown'>} UsualStrip   a strip before the choices by hand */
/** @typedef {Omit<UsualStrip, 'usual'>} Draft   a strip before the usual ones are chosen */

/**
 * Columns that are computed of those that arrive: bands, residuals, logarithms. For Samples.setColumns.
 * @param {string[]} columns
 * @returns {DerivedColumn[]}
 */
export function derivedColumns(columns) {
  /** @type {DerivedColumn[]} */
  const derived = [];
  const known = new Set(columns);
  for (const column of columns) {
    const [label, kind, ...rest] = column.split('.');
    const name = rest.join('.');
    if (kind === 'sigma') {
      const of = [`${label}.theta.${name}`, column];
      derived.push({name: `${label}.low.${name}`, of, make: (value, sigma) => value - BAND * sigma});
      derived.push({name: `${label}.high.${name}`, of, make: (value, sigma) => value + BAND * sigma});
    } else if (kind === 'y' && known.has(`y.${name}`)) {
      derived.push({
        name: `${label}.residual.${name}`,
        of: [`y.${name}`, column],
        make: (measured, estimate) => measured - estimate,
      });
    } else if (kind === 'pe' && rest.length === 0) {
      derived.push({
        name: `${label}.excitation`,
        of: [column],
        make: (value) => (value > 1e-12 ? Math.log10(value) : value === value ? -12 : NaN),
      });
    }
  }
  return derived;
}

/**
 * All strips of a session in their order.
 * @param {State} state
 * @returns {Strip[]}
 */
export function stripsOf({plant, columns, observers, faults, checks, strips: chosen, noise, presentation, lesson}) {
  if (!plant) return [];
  const known = new Set(columns);
  /** @param {Parameters<MakeTraces>[0]} make @returns {Trace[]} */
  const traces = (make) =>
    observers
      .map((observer) => ({
        label: observer.label,
        colour: observer.colour,
        place: observer.place,
        dashed: observer.dashed,
        fallen: observer.diverged?.t ?? null,
        ...make(observer),
      }))
      .filter(({column}) => known.has(column) || column.includes('.residual.') || column.endsWith('.excitation'));
  /** @type {UsualStrip[]} */
  const all = [
    ...channelStrips(plant, known, faults, traces),
    ...loopStrips(plant),
    ...inputStrips(plant, known),
    ...stateStrips(plant, traces),
    ...residualStrips(plant, noise, known, observers, traces),
    ...relationStrips(plant, known, traces),
    ...excitationStrip(known, observers, checks, traces),
  ];
  const few = presentation ? fewer(all) : () => true;
  const secret = lesson !== null && !lesson.truth;
  const line = lesson?.line;
  const sketch = lesson?.sketch;
  return all.map((strip) => ({
    ...strip,
    ...(line?.strip === strip.name ? lined(strip.base, line.at) : {}),
    ...(sketch?.strip === strip.name ? {sketch, base: spanned(strip.base, sketch)} : {}),
    truth: secret && strip.kind !== 'loop' ? null : strip.truth,
    shown: chosen[strip.name] ?? (strip.usual && few(strip)),
  }));
}

/**
 * A level on a strip, with room for it on the axis.
 * @param {Strip['base']} base
 * @param {number} at
 * @returns {Pick<Strip, 'line' | 'base'>}
 */
const lined = (base, at) => ({
  line: at,
  base: [Math.min(base?.[0] ?? 0, -1.15 * at), Math.max(base?.[1] ?? 0, 1.15 * at)],
});

/**
 * An axis with room for all that can be drawn.
 * @param {Strip['base']} base
 * @param {Sketched} sketch
 * @returns {[number, number]}
 */
const spanned = (base, {low, high}) => [Math.min(base?.[0] ?? low, low), Math.max(base?.[1] ?? high, high)];

/**
 * The strips of presentation mode: the fault channels and a state; if no observer estimates a fault, two states and a
 * residual.
 * @param {UsualStrip[]} all
 * @returns {(strip: UsualStrip) => boolean}
 */
function fewer(all) {
  const estimated = all.some((strip) => strip.kind === 'theta' && strip.traces.length > 0);
  /** @param {Strip['kind']} kind @param {number} count */
  const first = (kind, count) => all.filter((strip) => strip.kind === kind).slice(0, count);
  const chosen = new Set([...first('state', estimated ? 1 : 2), ...first('residual', estimated ? 0 : 1)]);
  return (strip) => strip.kind === 'theta' || chosen.has(strip);
}

/**
 * @param {Plant} plant
 * @param {Set<string>} known
 * @param {FaultState[]} faults
 * @param {MakeTraces} traces
 */
function channelStrips(plant, known, faults, traces) {
  const stirred = new Set(faults.map(({subject}) => subject));
  /** @type {Draft[]} */
  const drafts = plant.channels.map((channel) => {
    const {name, typical} = channel;
    const size = Math.abs(typical ?? 1);
    return {
      name: `theta.${name}`,
      kind: 'theta',
      symbol: name,
      subject: name,
      title: channel.title || name,
      unit: channel.unit,
      truth: `theta.${name}`,
      traces: traces(({label}) => ({
        column: `${label}.theta.${name}`,
        ...(known.has(`${label}.sigma.${name}`) ? {low: `${label}.low.${name}`, high: `${label}.high.${name}`} : {}),
      })),
      base: (typical ?? 1) < 0 ? [-1.5 * size, 0.7 * size] : [-0.7 * size, 1.5 * size],
      least: size,
      log: false,
      threshold: null,
      weight: 1.25,
      stirred: stirred.has(name),
    };
  });
  const order = drafts.filter((strip) => strip.traces.length || strip.stirred);
  const first = new Set(
    [...order.filter((strip) => strip.stirred), ...order.filter((strip) => !strip.stirred)].slice(0, MOST_CHANNELS),
  );
  return drafts.map((strip) => ({...strip, usual: first.has(strip) || strip.stirred === true}));
}

/**
 * The set points, each with the reading of its unit, and the inputs that controllers set.
 * @param {Plant} plant
 * @returns {UsualStrip[]}
 */
function loopStrips(plant) {
  if (!plant.controllers?.length) return [];
  const controlled = new Set(plant.controllers.flatMap(({outputs}) => outputs.map(({input}) => input)));
  const items = [
    ...plant.references.map((one) => ({...one, column: `r.${one.name}`})),
    ...plant.inputs.filter(({name}) => controlled.has(name)).map((one) => ({...one, column: `u.${one.name}`})),
  ];
  return items.map(({name, unit, description, column}) => {
    const read = plant.outputs.filter((one) => column.startsWith('r.') && one.unit === unit);
    return {
      name: column,
      kind: 'loop',
      symbol: name,
      subject: name,
      title: description ?? '',
      unit,
      truth: column,
      ...(read.length === 1 ? {reading: {column: `y.${read[0].name}`, label: read[0].name}} : {}),
      traces: [],
      base: null,
      least: 0,
      log: false,
      threshold: null,
      weight: 0.9,
      usual: true,
    };
  });
}

/**
 * The inputs that no controller sets, and the known signals: shown when they are chosen.
 * @param {Plant} plant
 * @param {Set<string>} known
 * @returns {UsualStrip[]}
 */
function inputStrips(plant, known) {
  const controlled = new Set((plant.controllers ?? []).flatMap(({outputs}) => outputs.map(({input}) => `u.${input}`)));
  const items = [
    ...(plant.inputs ?? []).map((one) => ({...one, column: `u.${one.name}`})),
    ...(plant.signals ?? []).map((one) => ({...one, column: `signal.${one.name}`})),
  ];
  return items
    .filter(({column}) => known.has(column) && !controlled.has(column))
    .map(({name, unit, description, column}) => ({
      name: column,
      kind: 'input',
      symbol: name,
      subject: name,
      title: description ?? '',
      unit,
      truth: null,
      reading: {column, label: name},
      traces: [],
      base: null,
      least: 0,
      log: false,
      threshold: null,
      weight: 0.8,
      usual: false,
    }));
}

/** @param {Plant} plant @param {MakeTraces} traces */
function stateStrips(plant, traces) {
  /** @type {Draft[]} */
  const drafts = plant.states.map(({name, unit, description}) => ({
    name: `x.${name}`,
    kind: 'state',
    symbol: name,
    subject: name,
    title: description ?? '',
    unit,
    truth: `x.${name}`,
    traces: traces(({label}) => ({column: `${label}.x.${name}`})),
    base: null,
    least: 0,
    log: false,
    threshold: null,
    weight: 1,
  }));
  const most = Math.max(0, ...drafts.map((strip) => strip.traces.length));
  const first = new Set(drafts.filter((strip) => strip.traces.length === most).slice(0, MOST_STATES));
  return drafts.map((strip) => ({...strip, usual: first.has(strip)}));
}

/**
 * @param {Plant} plant
 * @param {State['noise']} present
 * @param {Set<string>} known
 * @param {ObserverState[]} observers
 * @param {MakeTraces} traces
 * @returns {UsualStrip[]}
 */
function residualStrips(plant, present, known, observers, traces) {
  if (observers.length === 0) return [];
  return plant.outputs.map(({name, unit, description}, place) => {
    const noise = 3 * (present[name]?.std ?? 0);
    return {
      name: `residual.${name}`,
      kind: 'residual',
      symbol: name,
      subject: name,
      title: description ?? '',
      unit,
      truth: null,
      traces: traces(({label}) => ({column: `${label}.residual.${name}`})).filter(({label}) =>
        known.has(`${label}.y.${name}`),
      ),
      base: [-noise, noise],
      least: 0,
      log: false,
      threshold: null,
      weight: 0.8,
      usual: place < 2,
    };
  });
}

/**
 * Residuals that an observer computes for each channel, blind to its fault, in thresholds.
 * @param {Plant} plant
 * @param {Set<string>} known
 * @param {MakeTraces} traces
 * @returns {UsualStrip[]}
 */
function relationStrips(plant, known, traces) {
  return plant.channels
    .map(({name, title}) => ({
      name,
      title: title || name,
      traces: traces(({label}) => ({column: `${label}.residual.${name}`})).filter(({column}) => known.has(column)),
    }))
    .filter((one) => one.traces.length > 0)
    .map((one, place) => ({
      name: `relation.${one.name}`,
      kind: 'relation',
      symbol: one.name,
      subject: one.name,
      title: one.title,
      unit: '',
      truth: null,
      traces: one.traces,
      base: [0, 1.6],
      least: 1,
      log: false,
      threshold: 1,
      weight: 0.8,
      usual: place < MOST_CHANNELS,
    }));
}

/**
 * @param {Set<string>} known
 * @param {ObserverState[]} observers
 * @param {State['checks']} checks
 * @param {MakeTraces} traces
 * @returns {UsualStrip[]}
 */
function excitationStrip(known, observers, checks, traces) {
  const exciting = traces(({label}) => ({column: `${label}.excitation`})).filter(({label}) => known.has(`${label}.pe`));
  if (exciting.length === 0) return [];
  const [{label}] = exciting;
  const gain = observers.find((one) => one.label === label)?.gains.delta;
  const check = (checks[label] ?? []).find(
    ({name, threshold}) => name.code === 'check.excitation' && threshold !== null,
  );
  const delta = check?.threshold ?? (typeof gain === 'number' ? gain : 0);
  return [
    {
      name: 'excitation',
      kind: 'excitation',
      symbol: 'lambda_min',
      subject: '',
      title: '',
      unit: '',
      truth: null,
      traces: exciting,
      base: delta > 0 ? [Math.log10(delta) - 0.6, Math.log10(delta) + 0.6] : null,
      least: 1,
      log: true,
      threshold: delta > 0 ? Math.log10(delta) : null,
      weight: 0.8,
      usual: true,
    },
  ];
}
