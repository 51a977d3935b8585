// On a phone the panels are behind tabs at the foot of the page; elsewhere all panels are shown and the tabs are not.

import {fill, h} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */

const TABS = ['curves', 'inject', 'observers', 'diagnosis']; // which panels belong to each is in tabs.css

/** @param {App} app */
export function mountTabs(app) {
  const narrow = matchMedia('(max-width: 719px)');
  const bar = h('nav', {class: 'tabs'});
  const buttons = TABS.map((name) => h('button', {type: 'button', id: `tab-${name}`, onclick: () => choose(name)}));
  document.body.append(fill(bar, buttons));
  /** @param {string} name */
  const choose = (name) => {
    document.documentElement.dataset.tab = name;
    for (const button of buttons) button.setAttribute('aria-pressed', String(button.id === `tab-${name}`));
    scrollTo(0, 0);
  };
  const place = () => {
    bar.hidden = !narrow.matches;
  };
  narrow.addEventListener('change', place);
  app.subscribe(
    (state) => state.language,
    () => {
      bar.setAttribute('aria-label', t('page.tabs.label'));
      TABS.forEach((name, at) => {
        buttons[at].textContent = t(`page.tabs.${name}`);
      });
    },
  );
  app.subscribe(
    (state) => state.site,
    (site) => {
      if (site && narrow.matches) choose('inject');
    },
  );
  choose('curves');
  place();
}
