// The keys of the page.

import {fill, h} from '../../dom.js';
import {KEYS} from './keyboard.js';

export function showHelp(body, app) {
  const rows = KEYS.map(({keys, does}) => h('tr', {}, h('th', {scope: 'row'}, keys.map((key) => h('kbd', {}, app.text.keyNames[key] ?? key))), h('td', {}, app.text.keys[does])));
  fill(body, h('table', {class: 'keys'}, h('tbody', {}, rows)), h('p', {class: 'soft'}, app.text.keysNote));
}
