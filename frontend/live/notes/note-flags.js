// Flags of notes on the timeline: buttons over the rail. A click goes to the moment, Enter changes the text, Delete
// removes it; the arrow keys go from flag to flag. The card below a flag (note-card.js) has its text.

import {fill, h} from '../../common/dom.js';
import {s} from '../../widgets/svg.js';
import {mountCard} from './note-card.js';
import {lineOf, notesOf} from './note-words.js';
import {t} from '../../i18n/words.js';

/** @import {App, Note} from '../types.js' */

const HINT = 'note-keys';

/** A flag; its pole is at x = 3 of 14. */
const flag = () =>
  s(
    'svg',
    {viewBox: '0 0 14 14', width: 14, height: 14, 'aria-hidden': 'true'},
    s('path', {d: 'M3 14V1.500', class: 'pole'}),
    s('path', {d: 'M3 1.500h9l-2.300 3 2.300 3H3z', class: 'cloth'}),
  );

/**
 * Put the flags over a rail.
 * @param {HTMLElement} root
 * @param {App} app
 * @param {() => number} reach   where the rail ends, s
 */
export function mountFlags(root, app, reach) {
  const hint = h('span', {class: 'visually-hidden', id: HINT});
  const group = h('div', {class: 'flags', role: 'group'});
  root.append(group, hint);
  const card = mountCard(root, app, group);
  /** @type {Map<string, HTMLElement>} by the note's id */
  const flags = new Map();
  let current = ''; // the one that Tab reaches
  let end = 0;

  const build = () => {
    const {state} = app;
    const notes = [...notesOf(state)];
    if (state.noting && !notes.some(({id}) => id === state.noting?.id)) notes.push(state.noting);
    notes.sort((a, b) => a.t - b.t);
    const focused = group.contains(document.activeElement) ? document.activeElement : null;
    if (!notes.some(({id}) => id === current)) current = next(notes, flags.get(current));
    for (const id of flags.keys()) if (!notes.some((note) => note.id === id)) flags.delete(id);
    for (const note of notes) if (!flags.has(note.id)) flags.set(note.id, button(note.id));
    if (
      group.childElementCount !== notes.length ||
      notes.some(({id}, place) => group.children[place] !== flags.get(id))
    )
      fill(
        group,
        notes.map(({id}) => flags.get(id) ?? null),
      );
    for (const note of notes) show(note);
    if (focused && !focused.isConnected) (flags.get(current) ?? root.querySelector('.rail'))?.focus();
    else if (focused && document.activeElement !== focused && focused instanceof HTMLElement) focused.focus();
    group.hidden = notes.length === 0;
    hint.textContent = t(state.role === 'control' ? 'page.notes.keys' : 'page.notes.keys.viewer');
    group.setAttribute('aria-label', t('page.notes.label'));
    place();
  };
  /** @param {string} id */
  const button = (id) => {
    const one = h('button', {type: 'button', class: 'flag', 'data-note': id, 'aria-describedby': HINT}, flag());
    const noted = () => app.act.notes.find(id);
    one.addEventListener('click', () => {
      const note = noted();
      if (note) app.act.notes.visit(note);
    });
    one.addEventListener('pointerenter', () => card.show(noted()));
    one.addEventListener('focus', () => {
      reachable(id);
      card.show(noted());
    });
    return one;
  };
  /** @param {Note} note */
  const show = (note) => {
    const one = flags.get(note.id);
    if (!one) return;
    one.setAttribute('aria-label', lineOf(note, app.state));
    one.dataset.t = String(note.t);
    one.tabIndex = note.id === current ? 0 : -1;
  };
  /** @param {string} id */
  const reachable = (id) => {
    current = id;
    for (const [other, element] of flags) element.tabIndex = other === id ? 0 : -1;
  };
  const place = () => {
    end = reach();
    for (const one of flags.values()) one.style.left = `${(100 * Number(one.dataset.t)) / end}%`;
    ahead();
    card.place(end);
  };
  const ahead = () => {
    for (const one of flags.values()) one.classList.toggle('ahead', Number(one.dataset.t) > app.samples.now);
  };
  group.addEventListener('keydown', (event) => {
    const id = event.target instanceof Element ? event.target.closest('[data-note]')?.getAttribute('data-note') : null;
    if (!id || event.ctrlKey || event.metaKey || event.altKey) return;
    const note = app.act.notes.find(id);
    const all = [...flags.values()].sort((a, b) => Number(a.dataset.t) - Number(b.dataset.t));
    const at = all.findIndex((one) => one.dataset.note === id);
    const may = app.state.role === 'control';
    /** @type {{[key: string]: (() => unknown) | false | null}} */
    const keys = {
      ArrowLeft: () => all[Math.max(0, at - 1)].focus(),
      ArrowRight: () => all[Math.min(all.length - 1, at + 1)].focus(),
      Home: () => all[0].focus(),
      End: () => all[all.length - 1].focus(),
      Enter: may && note && (() => app.act.notes.edit(note)),
      Delete: may && note && (() => app.act.notes.remove(note)),
      Escape: card.shown() && (() => card.hide()),
    };
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act();
  });

  app.subscribe((state) => [state.spec?.notes, state.noting, state.language, state.role, state.session], build);
  app.onTick(() => {
    if (reach() !== end) place();
    else ahead();
  });
}

/**
 * The note that Tab reaches in place of one that has gone: the nearest in time, or the last one.
 * @param {Note[]} notes
 * @param {HTMLElement | undefined} gone
 */
function next(notes, gone) {
  const at = Number(gone?.dataset.t ?? Infinity);
  const nearest = notes.reduce(
    (/** @type {Note | null} */ best, note) =>
      best === null || Math.abs(note.t - at) <= Math.abs(best.t - at) ? note : best,
    null,
  );
  return nearest?.id ?? '';
}
