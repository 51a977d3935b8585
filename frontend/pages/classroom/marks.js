// Right and wrong, by shape first: a filled circle with a tick, an open one with a cross.

import {h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';

const PATHS = {right: 'M4 8.500l2.800 2.800L12 5.500', wrong: 'M5 5l6 6M11 5l-6 6'};

/** @param {'right' | 'wrong'} mark */
export const markOf = (mark) =>
  h(
    'svg',
    {
      viewBox: '0 0 16 16',
      class: `answer-mark ${mark}`,
      role: 'img',
      'aria-label': mark === 'right' ? t('page.classroom.right') : t('page.classroom.wrong'),
    },
    h('circle', {cx: 8, cy: 8, r: 7.2}),
    h('path', {d: PATHS[mark]}),
  );
