// The stored run of the observers on the record: its id, the runs that it can be compared with.

import {h} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {heading} from '../../../widgets/controls.js';

/** @import {RecordActions, RecordState} from '../types.js' */

/**
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function runCard({runs}, act) {
  const [latest, ...others] = runs;
  if (!latest) return null;
  return h(
    'section',
    {class: 'card run-card'},
    heading(t('page.records.run')),
    h('p', {}, t('page.records.run.stored', {id: latest.id.slice(0, 8)})),
    h('p', {class: 'soft'}, t('page.records.run.hint')),
    h('a', {class: 'quiet', href: `/runs/?run=${latest.id}`}, t('page.records.run.open')),
    others.length > 0 && [
      h('h3', {}, t('page.records.compare')),
      h(
        'ul',
        {class: 'compared'},
        others.map(({id, labels, shown}) =>
          h(
            'li',
            {},
            h(
              'label',
              {},
              h('input', {type: 'checkbox', checked: shown, onchange: () => act.compare(id, !shown)}),
              ' ',
              h('span', {}, labels.join(', ')),
              ' ',
              h('code', {}, id.slice(0, 6)),
            ),
          ),
        ),
      ),
    ],
  );
}
