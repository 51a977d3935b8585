// Above the strips: the legend, the length of the window, the choice of strips.

import {childrenOf, fill, h, query, symbol} from '../../common/dom.js';
import {brief, symbolic} from '../../common/names.js';
import {seconds} from '../../widgets/number-format.js';
import {link} from '../../widgets/controls.js';
import {nextPlane, quantitiesOf} from '../state/planes.js';
import {kept} from '../net/session.js';
import {t} from '../../i18n/words.js';

/** @import {Child, Properties} from '../../types/dom.js' */
/** @import {App, ObserverState, Scope, Strip} from '../types.js' */

/**
 * @param {HTMLElement} root
 * @param {App} app
 * @param {Scope} scope
 */
export function mountHead(root, app, scope) {
  const legend = h('ul', {class: 'legend'});
  const zoom = h('span', {class: 'zoom-state', hidden: true});
  const windows = h('div', {class: 'segments', role: 'group'});
  const menu = h('details', {class: 'menu strips-menu'});
  fill(root, legend, zoom, windows, menu);

  app.subscribe(
    (state) => [
      state.observers,
      state.parent?.id,
      state.language,
      state.columns,
      state.band,
      state.presentation,
      state.session,
      state.lesson?.truth,
      state.lesson?.diagnosis,
      typeof state.facts?.judged === 'number',
    ],
    () => {
      const focused = document.activeElement?.closest('.legend li')?.getAttribute('data-label');
      fill(legend, legendOf(app, scope));
      fitLegend(legend);
      const again = focused && legend.querySelector(`[data-label="${CSS.escape(focused)}"] button`);
      if (again instanceof HTMLElement) again.focus();
    },
  );
  new ResizeObserver(() => fitLegend(legend)).observe(root);
  app.subscribe(
    (state) => [state.window, state.selection, state.language, state.windows, state.looking],
    ([window, selection, , lengths, looking]) => {
      windows.setAttribute('aria-label', t('page.scope.window'));
      windows.title = t('page.scope.window.hint');
      fill(
        windows,
        [...lengths, null].map((length) =>
          h(
            'button',
            {
              type: 'button',
              'aria-pressed': String(length === window && (!selection || looking !== null)),
              onclick: () => app.act.window(length),
            },
            length === null ? t('page.scope.all') : t('page.scope.window-of', {s: length}),
          ),
        ),
      );
      zoom.hidden = !selection || looking !== null;
      if (selection) {
        const step = (selection[1] - selection[0]) / 50;
        fill(
          zoom,
          t('page.scope.zoomed', {from: seconds(selection[0], step), to: seconds(selection[1], step)}),
          h('button', {type: 'button', class: 'link', onclick: () => app.act.select(null)}, t('page.scope.follow')),
        );
      }
    },
  );
  app.subscribe(
    (state) => [state.plant, state.columns, state.strips, state.language, state.faults, state.observers, state.planes],
    () => fillMenu(menu, app),
  );
  menu.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !menu.open) return;
    event.preventDefault();
    menu.open = false;
    query('summary', menu).focus();
  });
  document.addEventListener('click', (event) => {
    if (menu.open && event.target instanceof Node && !menu.contains(event.target)) menu.open = false;
  });
}

/**
 * In presentation mode the legend keeps to one line: without room it drops the marks that mean the same everywhere,
 * the plainest first. Otherwise it is set closer, and wraps.
 * @param {HTMLElement} legend
 */
function fitLegend(legend) {
  const plain = childrenOf(legend)
    .filter((item) => !item.classList.contains('own'))
    .sort((a, b) => SPOKEN.indexOf(a.dataset.mark ?? '') - SPOKEN.indexOf(b.dataset.mark ?? ''));
  for (const item of plain) item.classList.remove('mute');
  const oneLine = () => legend.offsetHeight < 1.7 * (plain[0]?.offsetHeight ?? 0);
  legend.classList.remove('tight');
  if (!document.documentElement.classList.contains('presentation')) {
    legend.classList.toggle('tight', !oneLine());
    return;
  }
  for (const item of plain) {
    if (oneLine()) return;
    item.classList.add('mute');
  }
}

/** @param {App} app @param {Scope} scope */
function legendOf(app, scope) {
  const {state} = app;
  const {parent} = state;
  const forked = kept.forkOf(state.session);
  /**
   * @param {HTMLElement} mark
   * @param {Child} words
   * @param {Properties} [extra]
   */
  const item = (mark, words, extra = {}) =>
    h(
      'li',
      {title: typeof words === 'string' ? words : null, 'data-mark': mark.classList[1], ...extra},
      mark,
      h('span', {}, words),
    );
  /** @param {string} name @param {string | null} [style] */
  const key = (name, style = null) => h('span', {class: `key ${name}`, style, 'aria-hidden': 'true'});
  const banded = state.observers.filter(({label}) =>
    state.columns.some((column) => column.startsWith(`${label}.sigma.`)),
  );
  const diagnosed = state.lesson?.diagnosis ?? true;
  return [
    (state.lesson?.truth ?? true) && item(key('dash'), t('page.scope.truth')),
    ...state.observers.map((observer) =>
      nameOf(observer, banded, app, scope, key(observer.dashed ? 'solid dashed' : 'solid', `--c:${observer.colour}`)),
    ),
    banded.length > 0 && bandOf(banded, app, key),
    (state.lesson?.truth ?? true) && item(key('tinted'), t('page.scope.fault-active')),
    state.lesson?.line && item(key('alarm-line'), t('page.lesson.line')),
    diagnosed && item(key('triangle'), t('page.scope.alarm')),
    diagnosed && typeof state.facts?.judged === 'number' && item(key('hatched'), t('page.scope.not-judged')),
    parent &&
      item(
        key('ghost'),
        [link(t('page.scope.parent'), () => app.act.visit(parent.id), {title: t('page.scope.parent.hint')})],
        {
          class: 'own',
        },
      ),
    forked?.parent &&
      item(
        key('ghost'),
        [
          link(t('page.scope.fork', {t: seconds(forked.parent.t ?? 0, 0.1)}), () => app.act.visit(forked.id), {
            title: t('page.scope.fork.hint'),
          }),
        ],
        {class: 'own'},
      ),
  ];
}

/**
 * An observer's name; where several have a band, a button that leaves only its own.
 * @param {ObserverState} observer
 * @param {ObserverState[]} banded
 * @param {App} app
 * @param {Scope} scope
 * @param {HTMLElement} mark
 */
function nameOf({label}, banded, app, scope, mark) {
  const {band} = app.state;
  if (banded.length < 2 || !banded.some((one) => one.label === label))
    return h('li', {class: 'own', title: label}, mark, h('span', {}, label));
  return h(
    'li',
    {
      class: 'own',
      'data-label': label,
      onpointerenter: (event) => event.pointerType === 'mouse' && scope.point(label),
      onpointerleave: () => scope.point(null),
    },
    mark,
    h(
      'button',
      {
        type: 'button',
        class: 'name',
        title: t('page.scope.band-only', {label}),
        'aria-pressed': String(band === label),
        onclick: () => {
          scope.point(null);
          app.act.band(band === label ? null : label);
        },
      },
      label,
    ),
  );
}

/**
 * Whose bands are drawn: of all of them the colours, of the chosen one its name, and the way back to all.
 * @param {ObserverState[]} banded
 * @param {App} app
 * @param {(name: string, style?: string | null) => HTMLElement} key
 */
function bandOf(banded, app, key) {
  const {band} = app.state;
  const chosen = banded.length > 1 ? banded.find(({label}) => label === band) : null;
  const shown = chosen ? [chosen] : banded;
  return h(
    'li',
    {
      'data-mark': 'band',
      title: [!chosen && banded.length > 1 && t('page.scope.band.hint'), t('page.observers.bands-note')]
        .filter(Boolean)
        .join('\n'),
    },
    h(
      'span',
      {class: 'bands', 'aria-hidden': 'true'},
      shown.map(({colour}) => key('band', `--c:${colour}`)),
    ),
    h(
      'span',
      {},
      chosen
        ? t('page.scope.band-of', {label: chosen.label})
        : banded.length > 1
          ? t('page.scope.bands')
          : t('page.scope.band'),
    ),
    chosen &&
      h('button', {type: 'button', class: 'link', onclick: () => app.act.band(null)}, t('page.scope.all-bands')),
  );
}

const SPOKEN = ['band', 'triangle', 'tinted', 'dash', 'hatched']; // which marks lose their words first
const GROUPS = [
  ['theta', 'channels'],
  ['loop', 'loop'],
  ['input', 'inputs'],
  ['state', 'states'],
  ['residual', 'residuals'],
  ['relation', 'relations'],
  ['excitation', 'other'],
];

/** @param {HTMLElement} menu @param {App} app */
function fillMenu(menu, app) {
  const all = app.strips();
  /** @param {Strip} strip */
  const box = (strip) =>
    h(
      'label',
      {},
      h('input', {
        type: 'checkbox',
        checked: strip.shown,
        onchange: (event) => app.act.strip(strip.name, event.currentTarget.checked),
      }),
      strip.kind === 'excitation'
        ? t('page.scope.excitation')
        : symbolic(strip.symbol)
          ? symbol(strip.symbol)
          : brief(strip.title),
      h(
        'small',
        {},
        strip.kind === 'residual' ? t('page.scope.residual') : symbolic(strip.symbol) ? brief(strip.title) : '',
      ),
    );
  const groups = GROUPS.map(([kind, name]) => {
    const own = all.filter((strip) => strip.kind === kind);
    return own.length ? h('fieldset', {}, h('legend', {}, t(`page.scope.group.${name}`)), own.map(box)) : null;
  });
  const further = nextPlane(app.state.planes, quantitiesOf(app.state));
  const changed = Object.keys(app.state.strips).length > 0;
  fill(
    menu,
    h('summary', {title: t('page.scope.strips.hint')}, t('page.scope.strips')),
    h(
      'div',
      {class: 'menu-body'},
      groups,
      further &&
        h(
          'button',
          {
            type: 'button',
            class: 'link add-plane',
            title: t('page.planes.add.hint'),
            onclick: () => app.act.plane(app.state.planes.length, further),
          },
          t('page.planes.add'),
        ),
      changed &&
        h(
          'button',
          {type: 'button', class: 'link', onclick: () => app.act.strip(null)},
          t('page.scope.strips-default'),
        ),
    ),
  );
}
