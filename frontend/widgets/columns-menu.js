// A menu of the columns of a table; what is left out is kept in this browser.

import {fill, h} from '../common/dom.js';
import {t} from '../i18n/words.js';

/**
 * The columns of a table that are left out, and a menu that changes them.
 * @param {string} key   under which the browser keeps them
 * @param {() => void} changed
 */
export function createColumnsMenu(key, changed) {
  const place = `thetascope.columns.${key}`;
  let hidden = read(place);
  const list = h('div', {class: 'menu-list'});
  const root = h(
    'details',
    {
      class: 'columns-menu',
      onkeydown: (event) => {
        if (event.key !== 'Escape' || !root.open) return;
        event.stopPropagation();
        root.open = false;
        root.querySelector('summary')?.focus();
      },
    },
    h('summary', {class: 'quiet'}, t('page.columns')),
    list,
  );
  addEventListener('pointerdown', ({target}) => {
    if (root.open && target instanceof Node && !root.contains(target)) root.open = false;
  });

  /** @param {string} name @param {boolean} shown */
  function set(name, shown) {
    hidden = new Set(hidden);
    if (shown) hidden.delete(name);
    else hidden.add(name);
    try {
      localStorage.setItem(place, JSON.stringify([...hidden]));
    } catch {
      // without storage they last until the page is left
    }
    changed();
  }

  return {
    root,
    /** Whether a column is shown. @param {string} name */
    shows: (name) => !hidden.has(name),
    /** List the columns. @param {readonly (readonly [string, import('../types/dom.js').Child])[]} columns */
    show(columns) {
      fill(
        list,
        columns.map(([name, words]) => {
          const box = h('input', {
            type: 'checkbox',
            onchange: ({currentTarget}) => set(name, currentTarget.checked),
          });
          box.checked = !hidden.has(name);
          return h('label', {}, box, h('span', {}, words));
        }),
      );
    },
  };
}

/** @param {string} place @returns {Set<string>} */
function read(place) {
  try {
    const names = JSON.parse(localStorage.getItem(place) ?? '[]');
    return new Set(Array.isArray(names) ? names.map(String) : []);
  } catch {
    return new Set();
  }
}
