// A refusal in place of what was asked for: what was refused, why, and what to do.

import {h} from '../../common/dom.js';
import {explained, problemBlock} from '../../common/problem.js';
import {t} from '../../i18n/words.js';

/** @import {RecordState} from './types.js' */

/**
 * @param {Pick<RecordState, 'problem' | 'refused'>} state
 */
export function refusalCard({problem, refused}) {
  if (!problem) return null;
  const {errors} = problem;
  const work = refused ?? 'reading';
  return h(
    'section',
    {class: 'card', id: 'refused'},
    h('h2', {}, t(`page.records.refused.${work}`)),
    errors.length === 0
      ? problemBlock(problem)
      : h(
          'div',
          {role: 'alert'},
          h(
            'ul',
            {class: 'refusals'},
            errors.map((error) => h('li', {}, error.field && [h('code', {}, error.field), ' '], explained(error))),
          ),
        ),
  );
}
