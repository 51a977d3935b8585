// The tables of a study: names confused, sensitivity, points.

import {h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';
import {brief} from './plots.js';

/** @import * as service from '../../types/service.js' */
/** @import {Child} from '../../types/dom.js' */

/** @param {service.Confusion['counts']} counts */
export function confusionTable(counts) {
  const names = [...new Set(Object.values(counts).flatMap((row) => Object.keys(row)))].sort();
  /** @param {string} name */
  const words = (name) => (name === 'none' ? t('page.studies.none') : name === '' ? t('page.studies.unnamed') : name);
  const all = Object.entries(counts);
  return [
    h('h2', {}, t('page.studies.tab.confusion')),
    h(
      'table',
      {class: 'study-confusion'},
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          h('th', {scope: 'col'}, t('page.studies.true-fault')),
          names.map((name) => h('th', {scope: 'col'}, words(name))),
        ),
      ),
      h(
        'tbody',
        {},
        all.map(([fault, row]) => {
          const total = Object.values(row).reduce((sum, count) => sum + count, 0);
          return h(
            'tr',
            {},
            h('th', {scope: 'row'}, fault === '' ? t('page.studies.as-set') : words(fault)),
            names.map((name) => {
              const count = row[name] ?? 0;
              const right = fault === name || (fault !== 'none' && fault.split(' + ').includes(name));
              return h(
                'td',
                {class: right ? 'right' : '', style: `--share: ${count / total}`},
                count ? String(count) : '·',
              );
            }),
          );
        }),
      ),
    ),
    h('p', {class: 'soft'}, t('page.studies.confusion.hint')),
  ];
}

/** @param {service.SensitivityAnswer} one */
export function sensitivityLine({factor, first, rank}) {
  return h(
    'div',
    {class: 'study-bar-line'},
    h('span', {}, factor),
    h('span', {class: 'study-share'}, h('i', {style: `width: ${100 * (first ?? 0)}%`})),
    h('b', {class: 'num'}, first === null ? '–' : `${(100 * first).toFixed(0)} %`),
    h('span', {class: 'soft num'}, rank === null ? '' : t('page.studies.rank', {rank: Number(rank.toFixed(2))})),
  );
}

/**
 * @param {service.PointAnswers} table @param {readonly string[]} factors @param {(run: number) => void} open
 * @returns {Child[]}
 */
export function pointTable({measures, points}, factors, open) {
  return [
    h(
      'table',
      {},
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          factors.map((name) => h('th', {scope: 'col'}, name)),
          h('th', {scope: 'col'}, t('page.studies.column.runs')),
          measures.map((name) => h('th', {scope: 'col'}, name)),
        ),
      ),
      h(
        'tbody',
        {},
        points.slice(0, 1000).map((point) =>
          h(
            'tr',
            {},
            factors.map((name) => h('td', {class: 'num'}, brief(point.values[name]))),
            h(
              'td',
              {},
              h(
                'button',
                {type: 'button', class: 'link num', title: t('page.studies.open'), onclick: () => open(point.run)},
                String(point.runs),
              ),
            ),
            point.cells.map((cell) => h('td', {class: 'num'}, cell)),
          ),
        ),
      ),
    ),
    h('p', {class: 'soft'}, t('page.studies.table.hint')),
  ];
}
