// The plant and its copy side by side: two tanks, measured and predicted level, and what the difference does.

import {fill} from '../../common/dom.js';
import {s} from '../../widgets/svg.js';
import {t} from '../../i18n/words.js';

/** @import {App} from '../types.js' */

const WIDTH = 782;
const HEIGHT = 266;
const FULL = 16; // cm, to the rim
const TANK = {width: 112, height: 74};
const UPPER = 36;
const LOWER = 146;
const REAL = 110;
const COPY = 560;

/** @param {HTMLElement} element @param {App} app */
export function mountCopyPicture(element, app) {
  /** @type {(() => void)[]} */
  let updates = [];
  const draw = () => {
    const drawing = picture(app);
    updates = drawing.updates;
    fill(element, drawing.svg);
    tick();
  };
  const tick = () => {
    if (!element.hidden) for (const update of updates) update();
  };
  app.subscribe((state) => [state.language, state.lesson, state.observers.length, state.session, state.row], draw);
  app.onTick(tick);
}

/** @param {App} app */
function picture(app) {
  const [observer] = app.state.observers;
  const label = observer?.label ?? '';
  const colour = observer?.colour ?? 'var(--o0)';
  const truth = app.state.lesson?.truth ?? true;
  /** @type {(() => void)[]} */
  const updates = [];
  /**
   * A tank whose water follows a column.
   * @param {number} x
   * @param {number} y
   * @param {string} column
   * @param {string} fillColour
   * @param {string} line
   */
  const tank = (x, y, column, fillColour, line) => {
    const water = s('rect', {x: x + 1, width: TANK.width - 2, fill: fillColour});
    const surface = s('path', {stroke: line, 'stroke-width': 1.4, fill: 'none'});
    updates.push(() => {
      const value = Math.max(0, Math.min(FULL, app.latest(column) || 0));
      const height = (value / FULL) * TANK.height;
      water.setAttribute('y', String(y + TANK.height - height));
      water.setAttribute('height', String(height));
      surface.setAttribute('d', `M${x} ${y + TANK.height - height}h${TANK.width}`);
    });
    const walls = s('path', {
      d: `M${x} ${y}v${TANK.height}h${TANK.width}v${-TANK.height}`,
      fill: 'none',
      stroke: line,
      'stroke-width': 1.8,
      'stroke-linejoin': 'round',
    });
    return [water, surface, walls];
  };
  /** @param {number} x @param {string} line */
  const pipes = (x, line) =>
    [UPPER - 20, UPPER + TANK.height, LOWER + TANK.height].map((y) =>
      s('path', {
        d: `M${x + TANK.width / 2} ${y + 2}v${y < UPPER ? 16 : LOWER - UPPER - TANK.height - 6}`,
        stroke: line,
        'stroke-width': 3,
        opacity: 0.55,
      }),
    );
  /** @param {number} x @param {number} y @param {string} words @param {object} [more] */
  const text = (x, y, words, more = {}) =>
    s('text', {x, y, class: 'copy-words', 'text-anchor': 'middle', ...more}, words);
  /** @param {number} x @param {number} y @param {string} name @param {() => number} value @param {string} fillColour */
  const figure = (x, y, name, value, fillColour) => {
    const digits = s('tspan', {class: 'copy-digits', dx: 7});
    updates.push(() => {
      const now = value();
      digits.textContent = Number.isFinite(now)
        ? now
            .toFixed(1)
            .replace(/^-(?=0\.0$)/, '')
            .replace('-', '−')
        : '–';
    });
    return s('text', {x, y, class: 'copy-symbol', 'text-anchor': 'middle', fill: fillColour}, name, digits);
  };
  const y = LOWER + TANK.height / 2;
  const middle = (REAL + TANK.width + COPY) / 2;
  const hatched = s(
    'g',
    {class: 'copy-hidden'},
    s('rect', {x: REAL + 1, y: UPPER, width: TANK.width - 2, height: TANK.height, fill: 'url(#copy-hatch)'}),
    text(REAL + TANK.width / 2, UPPER + 18, t('page.lesson.picture.no-sensor')),
  );
  const listens = (observer?.gains.rho ?? 1) !== 1e-6;
  const svg = s(
    'svg',
    {viewBox: `0 -8 ${WIDTH} ${HEIGHT + 8}`, role: 'img', 'aria-label': t('page.lesson.picture.label')},
    s(
      'defs',
      {},
      s(
        'pattern',
        {id: 'copy-hatch', width: 7, height: 7, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)'},
        s('path', {d: 'M0 0V7', stroke: 'var(--line)', 'stroke-width': 2}),
      ),
      s(
        'marker',
        {
          id: 'copy-tip',
          viewBox: '0 0 8 8',
          refX: 7,
          refY: 4,
          markerWidth: 7,
          markerHeight: 7,
          orient: 'auto-start-reverse',
        },
        s('path', {d: 'M0 0L8 4L0 8z', fill: 'context-stroke'}),
      ),
    ),
    text(REAL + TANK.width / 2, 15, t('page.lesson.picture.real'), {class: 'copy-title'}),
    text(COPY + TANK.width / 2, 15, t('page.lesson.picture.copy'), {class: 'copy-title', style: `fill:${colour}`}),
    ...pipes(REAL, 'var(--soft)'),
    ...pipes(COPY, colour),
    hatched,
    ...(truth
      ? tank(REAL, UPPER, 'x.h1', 'transparent', 'var(--ink)')
      : [
          s('path', {
            d: `M${REAL} ${UPPER}v${TANK.height}h${TANK.width}v${-TANK.height}`,
            fill: 'none',
            stroke: 'var(--ink)',
            'stroke-width': 1.8,
          }),
        ]),
    ...tank(REAL, LOWER, truth ? 'x.h2' : 'y.y', 'var(--line)', 'var(--ink)'),
    ...tank(COPY, UPPER, `${label}.x.h1`, `color-mix(in oklab, ${colour} 24%, transparent)`, colour),
    ...tank(COPY, LOWER, `${label}.x.h2`, `color-mix(in oklab, ${colour} 24%, transparent)`, colour),
    figure(REAL - 50, UPPER + TANK.height / 2 + 6, 'h₁', () => (truth ? app.latest('x.h1') : NaN), 'var(--ink)'),
    figure(COPY + TANK.width + 55, UPPER + TANK.height / 2 + 6, 'ĥ₁', () => app.latest(`${label}.x.h1`), colour),
    s('path', {
      d: `M${REAL + TANK.width + 4} ${y}H${middle - 20}`,
      class: 'copy-wire',
      stroke: 'var(--ink)',
      'marker-end': 'url(#copy-tip)',
    }),
    s('path', {
      d: `M${COPY - 4} ${y}H${middle + 20}`,
      class: 'copy-wire',
      stroke: colour,
      'marker-end': 'url(#copy-tip)',
    }),
    s('circle', {cx: middle, cy: y, r: 16, fill: 'var(--bg)', stroke: 'var(--ink)', 'stroke-width': 1.4}),
    s('path', {d: `M${middle - 6} ${y}h12`, stroke: 'var(--ink)', 'stroke-width': 2}),
    text((REAL + TANK.width + middle) / 2 - 8, y - 12, t('page.lesson.picture.measured')),
    figure((REAL + TANK.width + middle) / 2 - 8, y + 24, 'y', () => app.latest('y.y'), 'var(--ink)'),
    text((COPY + middle) / 2 + 8, y - 12, t('page.lesson.picture.predicted')),
    figure((COPY + middle) / 2 + 8, y + 24, 'ŷ', () => app.latest(`${label}.y.y`), colour),
    figure(middle, y + 54, 'y − ŷ', () => app.latest('y.y') - app.latest(`${label}.y.y`), 'var(--ink)'),
    s('path', {
      d: listens
        ? `M${middle} ${y - 16}V${UPPER + 38}H${COPY - 4}`
        : `M${middle} ${y - 16}V${UPPER + 70}M${middle} ${UPPER + 62}L${middle - 12} ${UPPER + 44}` +
          `M${middle} ${UPPER + 44}V${UPPER + 38}H${COPY - 4}`,
      class: 'copy-wire',
      stroke: listens ? colour : 'var(--soft)',
      'stroke-width': listens ? 2.4 : 1.3,
      'marker-end': 'url(#copy-tip)',
    }),
    text(middle, UPPER + 24, listens ? t('page.lesson.picture.corrects') : t('page.lesson.picture.alone'), {
      style: `fill:${listens ? colour : 'var(--soft)'}`,
    }),
  );
  return {svg, updates};
}
