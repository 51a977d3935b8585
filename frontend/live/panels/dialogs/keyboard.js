// All keys of the page. They do nothing while text is typed, or in a control that uses the key itself.

import {TABS} from '../../ui/presentation.js';
import {SPEEDS} from '../../../widgets/number-format.js';
import {open} from './open-dialog.js';

/** @import {App, State} from '../../types.js' */

/** @typedef {{keys: string[], does: string, act?: (app: App, key: string) => unknown}} Key */

/** @type {Key[]} The keys and their actions; `does` names the words: page.help.keys.…. */
export const KEYS = [
  {keys: ['Space'], does: 'toggle', act: (app) => app.act.toggle()},
  {keys: ['.'], does: 'step', act: (app) => app.act.step(1)},
  {keys: ['ArrowLeft'], does: 'back', act: (app) => look(app, -1)},
  {keys: ['ArrowRight'], does: 'on', act: (app) => look(app, 1)},
  {
    keys: ['End', 'Escape'],
    does: 'now',
    act: (app, key) => (key === 'Escape' && leaves(app.state) ? app.act.present(false) : app.act.select(null)),
  },
  {keys: ['Home'], does: 'reset', act: (app) => app.act.reset()},
  {keys: ['+', '='], does: 'faster', act: (app) => app.act.speed(faster(app.state.speed, 1))},
  {keys: ['-'], does: 'slower', act: (app) => app.act.speed(faster(app.state.speed, -1))},
  {keys: ['F'], does: 'fork', act: (app) => app.act.fork()},
  {keys: ['N'], does: 'mark', act: (app) => app.act.notes.begin()},
  {keys: ['1', '…', '9'], does: 'site'},
  {keys: ['C'], does: 'clear', act: (app) => app.send({type: 'clear'})},
  {keys: ['E'], does: 'equations', act: () => open('equations')},
  {keys: ['P'], does: 'present', act: (app) => app.act.present(!app.state.presentation)},
  {keys: Object.values(TABS), does: 'desk', act: (app, key) => choose(app, key)},
  {keys: ['T'], does: 'theme', act: (app) => app.act.theme(app.state.theme === 'dark' ? 'light' : 'dark')},
  {keys: ['L'], does: 'language', act: (app) => app.act.language(app.state.language === 'en' ? 'zh' : 'en')},
  {keys: ['S'], does: 'share', act: () => open('share')},
  {keys: ['?'], does: 'help', act: () => open('help')},
];

/**
 * Whether Escape ends the presentation: only where there is nothing else that it would close.
 * @param {State} state
 */
const leaves = ({presentation, selection, looking}) =>
  presentation && !selection && looking === null && !document.querySelector('dialog[open], .menu[open]');

/**
 * Open the tab of a key while presenting; the focus stays, so that Space still plays.
 * @param {App} app
 * @param {string} key
 */
function choose(app, key) {
  const name = Object.entries(TABS).find(([, own]) => own === key)?.[0];
  if (!name || !app.state.presentation) return;
  if (!document.getElementById(`desk-${name}`)?.matches(':disabled')) app.act.desk(name);
}

/**
 * Move the scope by a tenth of its width; at the present time it follows time again.
 * @param {App} app
 * @param {1 | -1} by
 */
function look(app, by) {
  const {selection, window, t} = app.state;
  const [from, to] = selection ?? [t - (window ?? t), t];
  const step = (by * (to - from)) / 10;
  if (to + step >= t && by > 0) app.act.select(null);
  else app.act.select(Math.max(0, from + step), Math.max(to - from, to + step));
}

/**
 * The next speed up or down; null, as fast as possible, is the last.
 * @param {number | null} speed
 * @param {1 | -1} by
 */
export function faster(speed, by) {
  const place = speed === null ? SPEEDS.length - 1 : SPEEDS.findIndex((one) => one === null || one >= speed);
  return SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, place + by))];
}

/**
 * Buttons that keep the focus although nobody navigates by keyboard: one that was clicked, and one that gets the focus
 * back when Escape closes what it had opened. There Space belongs to the page; Enter still presses them, and after Tab
 * they are ordinary buttons.
 */
/** @type {WeakSet<Element>} */
let resting = new WeakSet();

const BUTTONS = 'button:not([role=tab]), a, summary, [role=button]';

/** @param {unknown} element */
function rest(element) {
  const button = element instanceof Element ? element.closest(BUTTONS) : null;
  if (button) resting.add(button);
}

/**
 * Whether an element has its own use for a key.
 * @param {Element} element
 * @param {string} key
 */
function own(element, key) {
  const dialog = element.closest('dialog');
  if (dialog) return dialog.open; // one that has just been closed keeps the focus until the page is drawn
  if (element.matches('input:not([type=range]), textarea, select, [contenteditable]')) return true;
  if (element.matches('input[type=range], [role=slider], [role=tab], [role=listbox] *'))
    return key.startsWith('Arrow') || ['Home', 'End', 'PageUp', 'PageDown'].includes(key);
  return element.matches(BUTTONS) && (key === 'Enter' || (key === ' ' && !resting.has(element)));
}

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  let taken = false; // Space was handled when it was pressed: a button must not act on its release (Firefox)
  let escaped = false; // the last key was Escape: the browser may give the focus back a frame later
  element.addEventListener('pointerdown', (event) => rest(event.target), true);
  element.addEventListener(
    'keydown',
    (event) => {
      escaped = event.key === 'Escape';
      if (event.key === 'Tab') resting = new WeakSet();
      if (escaped) setTimeout(() => rest(document.activeElement));
    },
    true,
  );
  element.addEventListener('focusin', (event) => {
    if (escaped) rest(event.target);
  });
  element.addEventListener('keyup', (event) => {
    if (event.key === ' ' && taken) event.preventDefault();
    taken = false;
  });
  element.addEventListener('keydown', (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target instanceof Element && own(event.target, event.key)) return;
    if (document.querySelector('dialog:modal')) return; // its keys are its own, wherever the focus is
    if (event.key === 'Escape' && document.querySelector(':popover-open')) return; // the browser closes it
    const name = event.key === ' ' ? 'Space' : event.key.length === 1 ? event.key.toUpperCase() : event.key;
    const channel = /^[1-9]$/.test(name) ? app.state.plant?.channels[Number(name) - 1] : null;
    const binding = KEYS.find((one) => one.act && one.keys.includes(name));
    if (!channel && !binding?.act) return;
    event.preventDefault();
    taken = name === 'Space';
    if (channel) {
      app.act.site(null);
      app.act.site(channel.name);
    } else Promise.resolve(binding?.act?.(app, name)).catch(app.act.refused);
  });
}
