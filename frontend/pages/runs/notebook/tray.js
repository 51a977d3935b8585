// What is done with the chosen runs: the tray at the bottom, the dialogs that ask, the notice with Undo.

import {fill, h} from '../../../common/dom.js';
import {nameOf} from './line-words.js';
import {t} from '../../../i18n/words.js';

/** @import * as service from '../../../types/service.js' */
/** @import {NotebookActions, NotebookState} from './notebook.js' */

export const FEWEST = 2;
export const MOST = 6;
const NOTICE_MS = 10_000;

/**
 * @param {HTMLElement} root
 * @param {NotebookActions} act
 */
export function createTray(root, act) {
  root.setAttribute('aria-label', t('page.notebook.tray'));

  /** @param {NotebookState} state */
  function show({chosen, lines}) {
    root.hidden = chosen.size === 0;
    if (root.hidden) return fill(root);
    const focused = root.contains(document.activeElement) ? document.activeElement?.getAttribute('data-key') : null;
    const many = chosen.size >= FEWEST && chosen.size <= MOST;
    const own = lines.filter((line) => chosen.has(line.id) && line.mine);
    const pinned = own.length > 0 && own.every((line) => line.pinned);
    const ids = own.map((line) => line.id);
    fill(
      root,
      h('span', {role: 'status'}, t('page.notebook.chosen', {n: chosen.size})),
      button('compare', many ? act.compare : null, [t('page.notebook.compare'), h('kbd', {}, 'C')], 'main'),
      !many && h('span', {class: 'hint'}, t('page.notebook.compare.hint')),
      button('tag', own.length ? () => act.tag(own) : null, t('page.notebook.tag')),
      button(
        'pin',
        own.length ? () => act.pin(ids, !pinned) : null,
        t(pinned ? 'page.notebook.unpin' : 'page.notebook.pin-chosen'),
      ),
      button('delete', own.length ? () => act.remove(own) : null, t('page.notebook.delete')),
      h(
        'button',
        {type: 'button', class: 'close', 'aria-label': t('page.notebook.choose-none'), onclick: act.chooseNone},
        '✕',
      ),
    );
    const again = focused ? root.querySelector(`[data-key="${focused}"]`) : null;
    if (again instanceof HTMLElement) again.focus();
    return root;
  }
  return {show};
}

/**
 * @param {string} key
 * @param {(() => unknown) | null} onclick
 * @param {import('../../../types/dom.js').Child} words
 * @param {string} [more]
 */
const button = (key, onclick, words, more = '') =>
  h('button', {type: 'button', class: `b ${more}`, 'data-key': key, disabled: !onclick, onclick}, words);

/**
 * A dialog with a form; resolves to its values when it is confirmed, to null when it is left.
 * @param {string} title
 * @param {import('../../../types/dom.js').Child} content
 * @param {string} confirm   words of the black button
 * @returns {Promise<FormData | null>}
 */
function ask(title, content, confirm) {
  /** @type {HTMLFormElement} */
  const form = h(
    'form',
    {method: 'dialog'},
    h('h2', {}, title),
    content,
    h(
      'div',
      {class: 'row-end'},
      h('button', {type: 'button', class: 'quiet', onclick: () => dialog.close()}, t('page.action.cancel')),
      h('button', {class: 'run', value: 'yes'}, confirm),
    ),
  );
  /** @type {HTMLDialogElement} */
  const dialog = h('dialog', {class: 'ask', 'aria-label': title}, form);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((done) => {
    dialog.addEventListener('close', () => {
      dialog.remove();
      done(dialog.returnValue === 'yes' ? new FormData(form) : null);
    });
  });
}

/** @param {string} words @param {string} name @param {string} value @param {string} [hint] */
const field = (words, name, value, hint = '') =>
  h(
    'label',
    {class: 'ask-field'},
    h('span', {}, words),
    h('input', {name, value, maxlength: 200, autocomplete: 'off'}),
    hint && h('small', {class: 'soft'}, hint),
  );

/** The tags in a text. @param {FormDataEntryValue | null} text */
const tagsOf = (text) =>
  String(text ?? '')
    .split(/[,，]/)
    .map((tag) => tag.trim())
    .filter(Boolean);

/**
 * Ask for the name and the tags of a run.
 * @param {service.RunLine} line
 * @returns {Promise<{name: string, tags: string[]} | null>}
 */
export async function askNotes(line) {
  const answer = await ask(
    t('page.notebook.edit', {name: nameOf(line)}),
    [
      field(t('page.notebook.column.name'), 'name', line.name),
      field(t('page.notebook.tags'), 'tags', line.tags.join(', '), t('page.notebook.tags.hint')),
    ],
    t('page.notebook.save'),
  );
  return answer && {name: String(answer.get('name') ?? ''), tags: tagsOf(answer.get('tags'))};
}

/**
 * Ask for tags that runs get besides theirs.
 * @param {number} n
 * @returns {Promise<string[] | null>}
 */
export async function askTags(n) {
  const title = t('page.notebook.tag-runs', {n});
  const answer = await ask(
    title,
    field(t('page.notebook.tags'), 'tags', '', t('page.notebook.tags.hint')),
    t('page.notebook.tag'),
  );
  return answer && tagsOf(answer.get('tags'));
}

/**
 * Ask whether runs are to be deleted.
 * @param {service.RunLine[]} lines
 */
export async function askDelete(lines) {
  const names = lines.map(nameOf).join(t('page.text.comma'));
  return Boolean(
    await ask(t('page.notebook.delete-runs', {n: lines.length}), h('p', {}, names), t('page.notebook.delete')),
  );
}

/**
 * The notice at the bottom of the page.
 * @param {HTMLElement} root
 */
export function createNotice(root) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const hide = () => {
    clearTimeout(timer);
    root.hidden = true;
    fill(root);
  };
  /**
   * @param {string} words
   * @param {() => unknown} [undo]
   */
  const tell = (words, undo) => {
    const back = () => {
      hide();
      undo?.();
    };
    fill(
      root,
      h('span', {}, words),
      undo && h('button', {type: 'button', class: 'b', onclick: back}, t('page.action.undo')),
    );
    root.hidden = false;
    clearTimeout(timer);
    timer = setTimeout(hide, NOTICE_MS);
  };
  return {tell, hide};
}
