// The bar of the editor: the lesson's name, save, play, worksheet, file and link.

import {post, Problem, reason, request} from '../../common/api.js';
import {fill, h} from '../../common/dom.js';
import {problemBlock} from '../../common/problem.js';
import {named, t} from '../../i18n/words.js';
import {emptyLesson, keepDraft, slug} from './draft.js';

/** @import * as service from '../../types/service.js' */
/** @import {DraftLesson} from './draft.js' */
/** @import {Editor} from './lesson-editor.js' */

/** @param {Editor} editor */
export function drawBar(editor) {
  const saved = editor.lesson.id;
  /** @param {string} shown @param {string} href */
  const link = (shown, href) => h('a', {class: 'press', href}, shown);
  const ready = editor.lesson.steps.length > 0;
  fill(
    editor.bar,
    h('h1', {}, named(editor.lesson.title) || t('page.editor.page-title')),
    h(
      'span',
      {class: 'soft', role: 'status'},
      editor.status || t('page.editor.count', {n: editor.lesson.steps.length}),
    ),
    h('span', {class: 'grow'}),
    h('button', {type: 'button', class: 'press', onclick: () => fresh(editor)}, t('page.editor.new')),
    h(
      'label',
      {class: 'press'},
      t('page.editor.open-file'),
      h('input', {
        type: 'file',
        class: 'file',
        accept: '.yaml,.yml,.json',
        onchange: (/** @type {Event} */ event) => upload(editor, event),
      }),
    ),
    editor.savedId && link(t('page.editor.file'), `/api/course/${saved}/file`),
    editor.savedId && link(t('page.worksheet.title'), `/worksheet/?lesson=${saved}`),
    editor.savedId && link(t('page.editor.play'), `/?lesson=${saved}`),
    editor.savedId &&
      h('button', {type: 'button', class: 'press', onclick: () => share(editor)}, t('page.editor.share')),
    h('button', {type: 'button', class: 'run', disabled: !ready, onclick: () => save(editor)}, t('page.editor.save')),
  );
}

/** @param {Editor} editor */
function fresh(editor) {
  editor.lesson = emptyLesson('');
  editor.place = 0;
  editor.savedId = editor.status = editor.problem = '';
  editor.played = null;
  editor.changed();
  editor.rebuild();
}

/** @param {Editor} editor */
async function save(editor) {
  try {
    editor.lesson.id ||= slug(editor.lesson.title.en ?? '');
    const saved = /** @type {service.MyLesson} */ (await post('/api/my-lessons', editor.whole()));
    editor.lesson.id = editor.savedId = saved.id;
    editor.status = t('page.editor.saved', {n: saved.version});
    keepDraft(editor.lesson);
  } catch (error) {
    refused(editor, error);
  }
  drawBar(editor);
}

/** @param {Editor} editor @param {Event} event */
async function upload(editor, event) {
  const file = /** @type {HTMLInputElement} */ (event.target).files?.[0];
  if (!file) return;
  try {
    const raw = new Blob([await file.text()], {
      type: file.name.endsWith('.json') ? 'application/json' : 'application/yaml',
    });
    const saved = /** @type {Omit<service.MyLesson, 'lesson'> & {lesson: DraftLesson}} */ (
      await request('POST', '/api/my-lessons', {raw})
    );
    editor.lesson = saved.lesson;
    editor.savedId = saved.id;
    editor.place = 0;
    editor.played = null;
    editor.status = t('page.editor.saved', {n: saved.version});
    editor.changed();
    editor.rebuild();
  } catch (error) {
    refused(editor, error);
  }
  drawBar(editor);
}

/** @param {Editor} editor */
async function share(editor) {
  const address = new URL(`/?lesson=${editor.savedId}`, location.href).href;
  try {
    await navigator.clipboard.writeText(address);
    editor.status = t('page.action.copied');
  } catch {
    editor.status = address; // to be copied by hand
  }
  drawBar(editor);
}

/** @param {Editor} editor @param {unknown} error */
function refused(editor, error) {
  editor.status = '';
  const block =
    error instanceof Problem ? problemBlock(error) : h('p', {class: 'alarm', role: 'alert'}, reason(error).message);
  editor.bar.after(block);
  setTimeout(() => block.remove(), 20_000);
}
