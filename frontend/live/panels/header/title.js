// The title of the experiment, and the choice of another.

import {childrenOf, fill, h} from '../../../common/dom.js';
import {experimentOn, ownPlants} from '../../../widgets/own-plants.js';
import {icon} from '../../../widgets/svg.js';
import {pack} from '../../state/permalink.js';
import {named, t} from '../../../i18n/words.js';

/** @import {ExperimentLine, Plant} from '../../../pages/types.js' */
/** @import {App, ObserverState} from '../../types.js' */
/** @import * as service from '../../../types/service.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const name = h('span', {class: 'what'});
  const button = h(
    'button',
    {type: 'button', class: 'experiment', 'aria-haspopup': 'true', 'aria-expanded': 'false', onclick: () => toggle()},
    h('h1', {}, name, icon('down', 13)),
  );
  const sub = h('p', {class: 'sub'});
  const filter = h('input', {type: 'search', autocomplete: 'off', spellcheck: 'false'});
  const list = h('ul', {class: 'choices'});
  const menu = h('div', {class: 'chooser-menu', hidden: true}, filter, list);
  fill(element, button, sub, menu);

  /** @param {boolean} [on] */
  const toggle = async (on = menu.matches('[hidden]')) => {
    menu.hidden = !on;
    button.setAttribute('aria-expanded', String(on));
    if (!on) return;
    const {experiments, plants} = await app.catalogue;
    const titles = Object.fromEntries(plants.map((plant) => [plant.id, plant.title]));
    fill(
      list,
      experiments.map((one) => entry(one, titles[one.plant])),
    );
    ownPlants().then((own) => list.append(...own.map(ownEntry)));
    filter.value = '';
    filter.placeholder = t('page.title.find');
    filter.setAttribute('aria-label', t('page.title.find'));
    filter.focus();
  };
  /** @param {service.ExperimentLine} one @param {string | undefined} plant */
  const entry = (one, plant) =>
    h(
      'li',
      {},
      h(
        'a',
        {
          href: `/?experiment=${encodeURIComponent(one.id)}`,
          'aria-current': one.id === app.state.experiment ? 'true' : null,
          onclick: (event) => {
            if (event.ctrlKey || event.metaKey || event.shiftKey) return;
            event.preventDefault();
            toggle(false);
            button.focus();
            app.act.open(one.id);
          },
        },
        h('b', {}, named(one.title) || one.id),
        h('span', {}, named(plant) ?? one.plant),
      ),
    );
  /** A plant that was saved in the workshop. @param {service.MyPlantLine} one */
  const ownEntry = (one) =>
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
            toggle(false);
            button.focus();
            try {
              const address = `/#s=${await pack({spec: await experimentOn(one.id), t: 0, play: true})}`;
              history.pushState(null, '', address);
              dispatchEvent(new PopStateEvent('popstate'));
            } catch (error) {
              app.act.refused(error);
            }
          },
        },
        h('b', {}, one.title || one.id),
        h('span', {}, t('page.workshop.mine')),
      ),
    );
  filter.addEventListener('input', () => {
    const words = filter.value.toLowerCase().split(/\s+/);
    for (const item of childrenOf(list))
      item.hidden = !words.every((word) => (item.textContent ?? '').toLowerCase().includes(word));
  });
  menu.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') {
      event.preventDefault();
      toggle(false);
      button.focus();
    }
    if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
    event.preventDefault();
    const links = [...list.querySelectorAll('a')].filter((link) => !link.closest('[hidden]'));
    const next =
      links[links.findIndex((link) => link === document.activeElement) + (event.key === 'ArrowDown' ? 1 : -1)];
    (next ?? (event.key === 'ArrowUp' ? filter : links[0]))?.focus();
  });
  document.addEventListener('pointerdown', (event) => {
    if (!menu.hidden && event.target instanceof Node && !element.contains(event.target)) toggle(false);
  });

  /** Write a name that does not fit smaller; if it then takes two lines, the subtitle gets one. */
  const fit = () => {
    button.classList.remove('long');
    button.classList.toggle('long', name.scrollWidth > name.clientWidth);
    button.classList.toggle('two-lines', name.offsetHeight > 2 * parseFloat(getComputedStyle(name).fontSize));
  };
  new ResizeObserver(fit).observe(element);

  app.subscribe(
    (state) => [named(state.spec?.title), state.plant, state.observers.length, state.language],
    () => {
      const {spec, plant, observers} = app.state;
      name.textContent = spec ? named(plant?.title) || named(spec.title) || spec.id : t('page.text.loading');
      fit();
      button.title = t('page.title.choose');
      fill(sub, spec && [named(spec.title), plant && h('span', {class: 'sizes'}, ` · ${sizes(plant, observers)}`)]);
      sub.title = [named(spec?.title), named(spec?.source)].filter(Boolean).join('. ');
    },
  );
}

/** @param {Plant} plant @param {ObserverState[]} observers */
const sizes = ({channels}, observers) =>
  t('page.title.sizes', {
    channels: t('page.title.channels', {n: channels.length}),
    observers: t('page.title.observers', {n: observers.length}),
  });
