// The place for a file: the whole page takes a dropped one; it can also be chosen or pasted.

import {h} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {icon} from '../../../widgets/svg.js';

/** @import {RecordActions, RecordState} from '../types.js' */

const SUFFIX_OF_PLANT = /\.ya?ml$/iu;

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function dropZone({inspection}, act) {
  const input = h('input', {
    type: 'file',
    id: 'file',
    class: 'visually-hidden',
    tabindex: -1,
    'aria-label': t('page.records.choose-file'),
    onchange: () => {
      const [file] = input.files ?? [];
      if (file) act.open(file);
    },
  });
  const choose = h(
    'button',
    {type: 'button', class: inspection ? 'link' : 'run', id: 'choose-file', onclick: () => input.click()},
    t('page.records.choose-file'),
  );
  if (inspection)
    return h(
      'div',
      {class: 'drop'},
      icon('export'),
      h('span', {}, t('page.records.drop.other')),
      choose,
      input,
      h('span', {class: 'soft formats'}, t('page.records.formats')),
    );
  return h(
    'section',
    {class: 'card drop empty-drop'},
    h('h2', {class: 'question'}, t('page.records.question')),
    h('p', {class: 'soft'}, t('page.records.about')),
    h('p', {class: 'drop-words'}, icon('export', 22), t('page.records.drop')),
    h(
      'div',
      {class: 'buttons'},
      choose,
      input,
      h(
        'button',
        {type: 'button', class: 'quiet', id: 'simulate', onclick: () => act.simulate()},
        t('page.records.simulate'),
      ),
    ),
    h('p', {class: 'soft formats'}, t('page.records.formats')),
    h(
      'ol',
      {class: 'intro'},
      [1, 2, 3].map((step) =>
        h(
          'li',
          {},
          h('span', {class: 'sign', 'aria-hidden': 'true'}, step),
          h('b', {}, t(`page.records.step.${step}`)),
          h('p', {class: 'soft'}, t(`page.records.intro.${step}`)),
        ),
      ),
    ),
  );
}

/**
 * Records that this browser has uploaded before.
 * @param {RecordState} state
 */
export const earlierCard = ({earlier}) =>
  earlier.length > 0 &&
  h(
    'section',
    {class: 'card'},
    h('h2', {}, t('page.records.earlier')),
    h(
      'ul',
      {class: 'earlier'},
      earlier.map(({id, name}) => h('li', {}, h('a', {href: `/records/?record=${encodeURIComponent(id)}`}, name))),
    ),
  );

/**
 * Let the whole page take dropped files and pasted text. A plant's file becomes the plant.
 * @param {RecordActions} act
 */
export function takeFiles(act) {
  /** @param {File} file */
  const take = async (file) => {
    if (SUFFIX_OF_PLANT.test(file.name) || (await isPlant(file))) await act.usePlantText(await file.text());
    else await act.open(file);
  };
  /** @param {DragEvent} event */
  const over = (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    document.body.classList.add('dropping');
  };
  addEventListener('dragenter', over);
  addEventListener('dragover', over);
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) document.body.classList.remove('dropping');
  });
  addEventListener('drop', (event) => {
    document.body.classList.remove('dropping');
    const [file] = event.dataTransfer?.files ?? [];
    if (!file) return;
    event.preventDefault();
    take(file);
  });
  addEventListener('paste', (event) => {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLTextAreaElement) return;
    const [file] = event.clipboardData?.files ?? [];
    const text = event.clipboardData?.getData('text/plain') ?? '';
    if (file) take(file);
    else if (text.includes('\n')) act.open(new File([text], t('page.records.pasted'), {type: 'text/csv'}));
  });
}

/** Whether a JSON file is a plant rather than a record. @param {File} file */
async function isPlant(file) {
  if (!/\.json$/iu.test(file.name) || file.size > 1e6) return false;
  const text = await file.text();
  return /"states"\s*:/u.test(text) && /"dynamics"\s*:/u.test(text);
}
