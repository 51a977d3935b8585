// The list on the left: new plants, my plants, the library.

import {fill, h} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';
import {versions} from './service.js';
import {isChanged} from './store.js';
import {ago} from './times.js';

/** @import {MyPlantLine, ShopActions, ShopStore} from './types.js' */

/**
 * @param {HTMLElement} root
 * @param {ShopStore} store
 * @param {ShopActions} act
 */
export function mountList(root, store, act) {
  const file = h('input', {
    type: 'file',
    accept: '.yaml,.yml,.json',
    hidden: true,
    'aria-label': t('page.workshop.new.file'),
    onchange: async () => {
      const [chosen] = file.files ?? [];
      if (chosen) act.openText(await chosen.text());
      file.value = '';
    },
  });
  const filter = h('input', {type: 'search', id: 'find-plant', oninput: () => showLibrary()});
  const mine = h('div', {class: 'mine'});
  const library = h('div');
  const fresh = h('div', {class: 'new-from'});
  const heading = h('h2');
  const own = h('h2');
  const shelf = h('h2');
  const fold = h('details', {}, h('summary', {class: 'shop-fold'}), h('div', {class: 'shop-fold-body'}));
  const wide = matchMedia('(min-width: 1180px)');
  fold.open = wide.matches;
  wide.addEventListener('change', () => {
    fold.open = wide.matches;
  });
  const body = /** @type {HTMLElement} */ (fold.lastElementChild);
  fill(body, heading, fresh, file, own, mine, shelf, filter, library);
  fill(root, fold);

  function words() {
    root.setAttribute('aria-label', t('page.workshop.plants'));
    fill(/** @type {HTMLElement} */ (fold.firstElementChild), t('page.workshop.plants'));
    heading.textContent = t('page.workshop.new');
    filter.placeholder = t('page.workshop.find-plant');
    filter.setAttribute('aria-label', t('page.workshop.find-plant'));
    fill(
      fresh,
      ['tank', 'motor', 'empty'].map((name) =>
        h(
          'button',
          {type: 'button', class: 'item', onclick: () => act.openTemplate(name)},
          h('span', {'aria-hidden': 'true'}, '+'),
          t(`page.workshop.new.${name}`),
        ),
      ),
      h(
        'button',
        {type: 'button', class: 'item', onclick: () => file.click()},
        h('span', {'aria-hidden': 'true'}, '↥'),
        t('page.workshop.new.file'),
      ),
    );
  }

  function showMine() {
    const {state} = store;
    fill(own, t('page.workshop.mine'), h('span', {class: 'n'}, String(state.mine.length)));
    const unsaved = state.source.kind !== 'mine' && isChanged(state);
    fill(
      mine,
      state.mine.length === 0 && !unsaved && h('p', {class: 'soft none'}, t('page.workshop.mine.none')),
      state.mine.map((line) => {
        const here = state.source.kind === 'mine' && state.source.id === line.id;
        const faults = t('page.workshop.faults', {n: line.faults});
        const about = line.ready ? faults : t('page.workshop.draft');
        return h(
          'div',
          {class: `entry${here ? ' on' : ''}`},
          h(
            'button',
            {type: 'button', class: 'item', 'aria-current': here ? 'true' : null, onclick: () => act.openMine(line.id)},
            h('b', {}, line.title || line.id),
            h(
              'span',
              {class: 'sub'},
              `${about} · ${t('page.workshop.version', {n: line.version})}, ${ago(line.saved)}`,
            ),
          ),
          here && line.version > 1 && versionMenu(line, state.source.version ?? line.version, act),
          line.mine &&
            h(
              'button',
              {
                type: 'button',
                class: 'remove',
                title: t('page.workshop.delete', {title: line.title || line.id}),
                'aria-label': t('page.workshop.delete', {title: line.title || line.id}),
                onclick: () => act.remove(line.id),
              },
              '×',
            ),
        );
      }),
    );
  }

  function showLibrary() {
    const {state} = store;
    const wanted = filter.value.trim().toLowerCase();
    const lines = state.library.filter((line) =>
      [line.id, named(line.title), line.source].join(' ').toLowerCase().includes(wanted),
    );
    fill(shelf, t('page.workshop.library'), h('span', {class: 'n'}, String(state.library.length)));
    fill(
      library,
      lines.map((line) => {
        const here = state.source.kind === 'library' && state.source.id === line.id;
        return h(
          'button',
          {
            type: 'button',
            class: `item${here ? ' on' : ''}`,
            'aria-current': here ? 'true' : null,
            onclick: () => act.openLibrary(line.id),
            title: named(line.description),
          },
          h('b', {}, named(line.title) || line.id),
          h('span', {class: 'sub'}, line.source),
        );
      }),
    );
  }
  words();
  store.subscribe((state) => [state.mine, state.source, isChanged(state)], showMine);
  store.subscribe((state) => [state.library, state.source], showLibrary);
}

/**
 * A menu of the versions of a plant, which are asked for when it is opened first.
 * @param {MyPlantLine} line
 * @param {number} shown
 * @param {ShopActions} act
 */
function versionMenu(line, shown, act) {
  const label = t('page.workshop.versions', {title: line.title || line.id});
  /** @param {Pick<MyPlantLine, 'version' | 'saved'>} one */
  const option = ({version, saved}) =>
    h(
      'option',
      {value: String(version), selected: version === shown},
      `${t('page.workshop.version', {n: version})}${saved ? `, ${ago(saved)}` : ''}`,
    );
  const menu = h('select', {class: 'versions', 'aria-label': label, title: label}, option({version: shown, saved: 0}));
  menu.addEventListener('change', () => act.openMine(line.id, Number(menu.value)));
  versions(line.id)
    .then(({plants}) => fill(menu, plants.map(option)))
    .catch(() => {
      menu.hidden = true;
    });
  return menu;
}
