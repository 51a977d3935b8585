// The card below a flag of the timeline: the note's text while its flag has the pointer or the focus, and a field for
// it while it is changed. Enter keeps the text; so does leaving the field, which loses nothing; Escape gives it up.

import {fill, h} from '../../common/dom.js';
import {lineOf, momentOf, notesOf} from './note-words.js';
import {t} from '../../i18n/words.js';

/** @import {App, Note} from '../types.js' */

const MOST = 500; // characters, as the service takes them (MAX_NOTE)
const LEAVES = 250; // ms for the pointer on its way from the flag to the card

/**
 * The card's handle for the flags.
 * @typedef {object} NoteCard
 * @property {(note: Note | null) => void} show
 * @property {() => void} hide
 * @property {() => boolean} shown
 * @property {(end: number) => void} place   where the rail ends, s
 */

/**
 * @param {HTMLElement} root     the timeline
 * @param {App} app
 * @param {HTMLElement} flags
 * @returns {NoteCard}
 */
export function mountCard(root, app, flags) {
  const card = h('div', {class: 'note-card', hidden: true});
  root.append(card);
  /** @type {Note | null} */
  let shown = null;
  /** @type {{note: Note, field: HTMLInputElement, from: Element | null} | null} */
  let editing = null;
  let [end, timer] = [1, 0];

  const hide = () => {
    clearTimeout(timer);
    if (editing) return;
    shown = null;
    card.hidden = true;
    fill(card);
  };
  /** Hide the text soon, unless the pointer or the focus is still there. */
  const leave = () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      if (!card.matches(':hover, :focus-within') && !flags.querySelector(':hover, :focus')) hide();
    }, LEAVES);
  };
  /** @param {Note | null} note */
  const show = (note) => {
    clearTimeout(timer);
    if (editing || !note) return;
    shown = note;
    const may = app.state.role === 'control';
    /** @param {string} words @param {() => unknown} act */
    const button = (words, act) => h('button', {type: 'button', class: 'link', tabindex: -1, onclick: act}, words);
    fill(
      card,
      h('p', {}, lineOf(note, app.state)),
      may &&
        h(
          'div',
          {class: 'note-acts'},
          button(t('page.notes.edit'), () => app.act.notes.edit(note)),
          button(t('page.notes.remove'), () => app.act.notes.remove(note)),
        ),
    );
    card.hidden = false;
    place();
  };
  /** @param {Note} note */
  const edit = (note) => {
    clearTimeout(timer);
    const at = momentOf(note, app.state);
    const field = h('input', {
      type: 'text',
      maxlength: MOST,
      autocomplete: 'off',
      placeholder: t('page.notes.placeholder'),
      'aria-label': t('page.notes.field', {t: at}),
    });
    field.value = note.text;
    editing = {note, field, from: document.activeElement};
    fill(
      card,
      h(
        'form',
        {
          onsubmit(event) {
            event.preventDefault();
            void keep();
          },
        },
        h('span', {class: 'soft', 'aria-hidden': 'true'}, t('page.notes.at', {t: at})),
        field,
        h('button', {type: 'submit', class: 'quiet'}, t('page.notes.keep')),
      ),
    );
    card.hidden = false;
    place();
    field.focus({preventScroll: true});
    field.select();
  };
  /** Keep what is typed and close the card; where it is refused, the card stays, and the notice says why. */
  const keep = async () => {
    if (!editing) return;
    const {note, field} = editing;
    const text = field.value.trim();
    const known = app.act.notes.find(note.id);
    if ((known && known.text === text) || (await app.act.notes.keep({...note, text}))) {
      if (editing?.note.id === note.id) app.act.notes.close();
    }
  };
  const close = () => {
    const {from, note} = editing ?? {};
    const within = card.contains(document.activeElement);
    editing = null;
    hide();
    if (!within) return;
    const flag = flags.querySelector(`[data-note="${note?.id}"]`);
    const back = from instanceof HTMLElement && from.isConnected && from !== document.body ? from : null;
    if (back) back.focus({preventScroll: true});
    else if (from !== document.body && flag instanceof HTMLElement) flag.focus({preventScroll: true});
    else if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
  };
  /** Below the flag, within the timeline. */
  const place = () => {
    const note = editing?.note ?? shown;
    if (!note || card.hidden) return;
    const x = (note.t / end) * root.clientWidth;
    card.style.left = `${Math.max(0, Math.min(x - card.offsetWidth / 2, root.clientWidth - card.offsetWidth))}px`;
  };

  card.addEventListener('keydown', (event) => {
    event.stopPropagation(); // what is typed is no key of the page
    if (event.key !== 'Escape') return;
    event.preventDefault();
    app.act.notes.close();
  });
  card.addEventListener('focusout', (event) => {
    const to = event.relatedTarget;
    if (editing && document.hasFocus() && !(to instanceof Node && card.contains(to))) void keep();
  });
  for (const element of [card, flags]) {
    element.addEventListener('pointerleave', leave);
    element.addEventListener('focusout', leave);
  }
  card.addEventListener('pointerenter', () => clearTimeout(timer));
  app.subscribe(
    (state) => state.noting,
    (noting) => {
      if (noting && noting.id !== editing?.note.id) edit(noting);
      else if (!noting && editing) close();
    },
  );
  app.subscribe(
    (state) => [state.spec?.notes, state.language, state.role, state.session],
    () => {
      if (!shown || editing) return;
      const known = notesOf(app.state).find(({id}) => id === shown?.id);
      if (known) show(known);
      else hide();
    },
  );
  return {
    show,
    hide,
    shown: () => !card.hidden && !editing,
    place(to) {
      end = to;
      place();
    },
  };
}
