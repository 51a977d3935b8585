// The library: experiments under their plants. On a narrow screen it folds away behind the choice.

import {fill, h, query} from '../../common/dom.js';
import {experimentOn, ownPlants} from '../../widgets/own-plants.js';
import {write} from './address.js';
import {named, t} from '../../i18n/words.js';

/** @import {ExperimentLine, RunActions, RunStore} from '../types.js' */

const MANY = 8; // with this many experiments there is a search field

/**
 * @param {HTMLElement} root
 * @param {RunStore} store
 * @param {RunActions} act
 */
export function mountChooser(root, store, act) {
  const wide = matchMedia('(min-width: 1180px)');
  /** @type {HTMLInputElement} */
  const filter = h('input', {
    type: 'search',
    placeholder: t('page.title.find'),
    'aria-label': t('page.title.find'),
    oninput: show,
  });
  const list = h('div', {class: 'list'});
  const own = h('div', {class: 'list own-plants'});
  const fold = h(
    'details',
    {},
    h('summary', {}, h('h2', {}, t('page.runs.experiments')), h('span', {class: 'now'})),
    filter,
    list,
    own,
  );
  fold.open = wide.matches;
  wide.addEventListener('change', () => {
    fold.open = wide.matches;
  });
  fill(root, h('a', {class: 'all-runs', href: '/runs/'}, t('page.notebook.all-runs')), fold);
  root.setAttribute('aria-label', t('page.runs.experiments'));

  function show() {
    const {experiments, chosen, spec} = store.state;
    fill(query('.now', fold), named(spec?.title) ?? '');
    filter.hidden = (experiments?.length ?? 0) < MANY;
    if (experiments === null) return fill(list, h('p', {class: 'soft'}, t('page.text.loading')));
    if (experiments.length === 0) return fill(list, h('p', {class: 'soft'}, t('page.runs.no-experiments')));
    const wanted = filter.value.trim().toLowerCase();
    const matching = experiments.filter((one) =>
      [one.id, one.title, one.source, one.description].join(' ').toLowerCase().includes(wanted),
    );
    if (matching.length === 0)
      return fill(list, h('p', {class: 'soft'}, t('page.runs.no-match', {text: filter.value})));
    const plants = [...new Set(matching.map((one) => one.plant))];
    return fill(
      list,
      plants.map((plant) => [
        h('h3', {}, named(store.state.plants[plant]?.title) ?? plant),
        h(
          'ul',
          {},
          matching.filter((one) => one.plant === plant).map((one) => entry(one, one.id === chosen)),
        ),
      ]),
    );
  }

  /** @param {ExperimentLine} one @param {boolean} current */
  function entry(one, current) {
    /** @param {MouseEvent} event */
    const open = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return; // a new tab, as with any link
      event.preventDefault();
      fold.open = wide.matches;
      act.choose(one.id);
    };
    return h(
      'li',
      {},
      h(
        'a',
        {
          href: write({experiment: one.id}),
          'aria-current': current ? 'true' : null,
          onclick: open,
          title: named(one.description),
        },
        h('b', {}, named(one.title) || one.id),
        h('span', {class: 'soft'}, one.source),
      ),
    );
  }

  /** Plants that were saved in the workshop: a run with two observers and the plant's first fault. */
  async function showOwn() {
    const plants = await ownPlants();
    if (plants.length === 0) return;
    fill(
      own,
      h('h3', {}, t('page.workshop.mine')),
      h(
        'ul',
        {},
        plants.map((one) =>
          h(
            'li',
            {},
            h(
              'a',
              {
                href: `/workshop/?plant=${encodeURIComponent(one.id)}`,
                onclick: async (event) => {
                  if (event.ctrlKey || event.metaKey || event.shiftKey) return;
                  event.preventDefault();
                  const link = event.currentTarget;
                  link.setAttribute('aria-busy', 'true');
                  await act.runSpec(() => experimentOn(one.id, {fault: true}));
                  link.removeAttribute('aria-busy');
                },
              },
              h('b', {}, one.title || one.id),
              h('span', {class: 'soft'}, t('page.workshop.version', {n: one.version})),
            ),
          ),
        ),
      ),
    );
  }
  showOwn();

  store.subscribe((state, before) => {
    if (state.experiments !== before.experiments || state.chosen !== before.chosen || state.spec !== before.spec) {
      const focused = list.contains(document.activeElement);
      show();
      const current = list.querySelector('[aria-current]');
      if (focused && current instanceof HTMLElement) current.focus();
    }
  });
  show();
}
