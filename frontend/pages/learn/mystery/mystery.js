// Mystery: a record plays, somebody says what is wrong and since when, and meets the detector.

import {connection, get} from '../../../common/api.js';
import {fill, query} from '../../../common/dom.js';
import {mountTop} from '../../../common/page-header.js';
import {speak, t} from '../../../i18n/words.js';
import {chosenLanguage} from '../../../i18n/language.js';
import {Game} from './game.js';
import {keepPlace} from './place.js';

/** @import * as service from '../../../types/service.js' */

await speak(chosenLanguage());
const game = new Game();
const label = () => {
  document.title = t('page.mystery.page-title');
  fill(query('.skip'), t('page.nav.skip-to-mystery'));
};
mountTop(query('header'), connection, 'learn', () => {
  label();
  game.show();
});
label();
addEventListener('popstate', () => game.open());
addEventListener('pagehide', () => keepPlace(game.place));
document.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || game.solution) return;
  const at = event.target instanceof Element ? event.target : document.body;
  if (at.matches('input:not([type=range], [type=radio], [type=checkbox]), select, textarea')) return;
  if (event.key === ' ' && !at.matches('button, a, input, summary')) {
    event.preventDefault();
    game.toggle();
  } else if (event.key.toLowerCase() === 'a') game.accuse();
  else if (/^[0-9]$/.test(event.key)) game.question.choose((Number(event.key) + 9) % 10);
});
game.setups = /** @type {service.MysterySetups} */ (await get('/api/mysteries')).setups;
await game.open();
