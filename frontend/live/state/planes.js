// Phase planes: which quantities a session has, and which curves a pair of them makes. Pure.

/** @import {State} from '../types.js' */

/**
 * A quantity: `truth` is the column of its value, or of its true value; `kind` says where observers keep theirs.
 * @typedef {{id: string, kind: 'state' | 'theta' | 'output' | 'estimated' | 'residual' | 'input', name: string,
 *   truth: string | null, observer: string | null}} Quantity   `observer`: a column without its label
 */

/** @typedef {{x: string, y: string}} Plane   ids of quantities */
/** @typedef {{label: string | null, x: string, y: string}} PlaneCurve   label: null of the true values */

export const MOST_PLANES = 3;

/**
 * All quantities of a session in their order.
 * @param {Pick<State, 'plant' | 'columns' | 'lesson' | 'observers'>} state
 * @returns {Quantity[]}
 */
export function quantitiesOf({plant, columns, lesson, observers}) {
  if (!plant) return [];
  const known = new Set(columns);
  const secret = lesson !== null && !lesson.truth;
  /** @param {string} column */
  const estimated = (column) => observers.some(({label}) => known.has(`${label}.${column}`));
  /** @type {Quantity[]} */
  const all = [
    ...plant.states.map(({name}) => own('state', name, secret ? null : `x.${name}`, `x.${name}`)),
    ...plant.channels.map(({name}) => own('theta', name, secret ? null : `theta.${name}`, `theta.${name}`)),
    ...plant.outputs.flatMap(({name}) => [
      own('output', name, `y.${name}`, null),
      own('estimated', name, null, `y.${name}`),
      own('residual', name, null, `residual.${name}`),
    ]),
    ...plant.inputs.map(({name}) => own('input', name, `u.${name}`, null)),
    ...(plant.references ?? []).map(({name}) => own('input', name, `r.${name}`, null)),
    ...plant.signals.map(({name}) => own('input', name, `signal.${name}`, null)),
  ];
  return all.filter(
    ({truth, observer}) =>
      (truth !== null && known.has(truth)) || (observer !== null && estimated(observer.replace('residual.', 'y.'))),
  );
}

/**
 * @param {Quantity['kind']} kind
 * @param {string} name
 * @param {string | null} truth
 * @param {string | null} observer
 * @returns {Quantity}
 */
const own = (kind, name, truth, observer) => ({id: `${kind}.${name}`, kind, name, truth, observer});

/**
 * The curves of a plane: one of the true values, and one of each observer that estimates a quantity. What nobody
 * estimates, such as an input, is common to all.
 * @param {Quantity} x
 * @param {Quantity} y
 * @param {Pick<State, 'columns' | 'observers'>} state
 * @returns {PlaneCurve[]}
 */
export function curvesOf(x, y, {columns, observers}) {
  const known = new Set(columns);
  /** @param {Quantity} quantity @param {string} label */
  const of = ({truth, observer}, label) => {
    if (observer === null) return truth;
    const arriving = `${label}.${observer.replace('residual.', 'y.')}`;
    return known.has(arriving) ? `${label}.${observer}` : null;
  };
  /** @type {PlaneCurve[]} */
  const curves = [];
  if (x.observer !== null || y.observer !== null)
    for (const {label} of observers) {
      const pair = [of(x, label), of(y, label)];
      if (pair[0] !== null && pair[1] !== null) curves.push({label, x: pair[0], y: pair[1]});
    }
  if (x.truth !== null && y.truth !== null) curves.push({label: null, x: x.truth, y: y.truth});
  return curves;
}

/**
 * The plane that is added next: the first two states that no plane shows, else a residual over its estimate, else any.
 * @param {readonly Plane[]} planes
 * @param {readonly Quantity[]} quantities
 * @returns {Plane | null}
 */
export function nextPlane(planes, quantities) {
  if (quantities.length < 2 || planes.length >= MOST_PLANES) return null;
  /** @param {Quantity['kind']} kind */
  const ids = (kind) => quantities.filter((one) => one.kind === kind).map(({id}) => id);
  const states = ids('state');
  /** @type {Plane[]} */
  const usual = [
    {x: states[0], y: states[1]},
    {x: ids('estimated')[0], y: ids('residual')[0]},
    {x: ids('theta')[0], y: ids('theta')[1]},
    {x: quantities[0].id, y: quantities[1].id},
  ].filter((plane) => plane.x !== undefined && plane.y !== undefined);
  return usual.find((plane) => !planes.some(({x, y}) => x === plane.x && y === plane.y)) ?? usual[0];
}
