// What the page is, its keys, the meaning of the marks on the curves and on the timeline, and the terms.

import {fill, h} from '../../../common/dom.js';
import {KEYS} from './keyboard.js';
import {hintsShown} from '../../ui/first-sight.js';
import {t} from '../../../i18n/words.js';

/** @import {Child} from '../../../types/dom.js' */

/** @param {...Child} parts */
const svg = (...parts) => h('svg', {viewBox: '0 0 26 14', width: 26, height: 14, 'aria-hidden': 'true'}, parts);
/**
 * @param {string} d
 * @param {string} colour
 * @param {boolean} [filled]
 * @param {{[attribute: string]: string | number}} [more]
 */
const path = (d, colour, filled = true, more = {}) =>
  h('path', {d, fill: filled ? colour : 'none', stroke: filled ? 'none' : colour, 'stroke-width': 1.6, ...more});

/** The marks on strips and timeline, as they are drawn there. */
const MARKS = {
  truth: () => path('M1 7H25', 'var(--ink)', false, {'stroke-dasharray': '5 3'}),
  band: () => path('M1 3Q13 0 25 3V11Q13 8 1 11Z', 'var(--o0)', true, {opacity: 0.25}),
  tint: () => [path('M1 0H25V14H1Z', 'var(--fault-soft)'), path('M1.500 0V14', 'var(--fault-line)', false)],
  alarm: () => path('M7 2H19L13 11Z', 'var(--alarm)'),
  second: () => path('M8 2.500H18L13 10.500Z', 'var(--alarm)', false),
  'alarm-on': () => path('M1 2H25', 'var(--alarm)', false, {'stroke-width': 2.5, opacity: 0.6}),
  onset: () => path('M8 9H18V14H8Z', 'var(--alarm)', true, {opacity: 0.5}),
  leaves: () => path('M9 9L13 3L17 9Z', 'var(--o0)'),
  threshold: () => path('M1 7H25', 'var(--alarm)', false, {'stroke-dasharray': '3 4', 'stroke-width': 1}),
  fallen: () => path('M9 3L17 11M9 11L17 3', 'var(--o1)', false, {'stroke-width': 2}),
  bar: () => path('M1 5H25V9H1Z', 'var(--fault)'),
  change: () => path('M13 6V14', 'var(--ink)', false),
  flag: () => [path('M9 13V2', 'var(--accent)', false), path('M9 2h9l-2.300 3L18 8H9z', 'var(--accent)')],
  escaped: () => path('M9 3L17 11M9 11L17 3', 'var(--alarm)', false, {'stroke-width': 2}),
};

/** Keys whose name differs from their label. */
/** @type {{[key: string]: () => string}} */
const KEY_NAMES = {
  Space: () => t('page.help.key.space'),
  ArrowLeft: () => '←',
  ArrowRight: () => '→',
  Escape: () => 'Esc',
};

/** What estimates, what decides, and what the most frequent marks say; then the other terms of the page. */
const PARTS = ['observer', 'detector', 'amber', 'triangle', 'dashed'];
const TERMS = [
  ...['fault', 'channel', 'estimate', 'residual', 'band', 'excitation', 'gain', 'threshold'],
  ...['alternatives', 'rmse', 'delay', 'model'],
];

/** @param {[term: string, meaning: string][]} entries */
const definitions = (entries) =>
  h(
    'dl',
    {class: 'definitions'},
    entries.map(([term, meaning]) => [h('dt', {}, term), h('dd', {}, meaning)]),
  );

const hintsButton = () =>
  h('button', {type: 'button', class: 'link', onclick: () => hintsShown(true)}, t('page.first.show'));

/** @param {HTMLElement} body */
export function showHelp(body) {
  const rows = KEYS.map(({keys, does}) =>
    h(
      'tr',
      {},
      h(
        'th',
        {scope: 'row'},
        keys.map((key) => h('kbd', {}, KEY_NAMES[key]?.() ?? key)),
      ),
      h('td', {}, t(`page.help.keys.${does}`)),
    ),
  );
  fill(
    body,
    h('p', {class: 'introduction'}, t('page.help.introduction')),
    definitions(PARTS.map((name) => [t(`page.help.part.${name}.term`), t(`page.help.part.${name}.meaning`)])),
    h('p', {class: 'soft'}, hintsButton(), ' ', h('a', {href: '/learn/'}, t('page.first.learn'))),
    h('h3', {}, t('page.help.keys')),
    h('table', {class: 'keys'}, h('tbody', {}, rows)),
    h('p', {class: 'soft'}, t('page.help.keys.note')),
    h('h3', {}, t('page.help.marks')),
    h(
      'table',
      {class: 'keys marks-list'},
      h(
        'tbody',
        {},
        Object.entries(MARKS).map(([name, draw]) =>
          h('tr', {}, h('td', {}, svg(...[draw()].flat())), h('td', {}, t(`page.marks.${name}`))),
        ),
      ),
    ),
    h('h3', {}, t('page.help.glossary')),
    definitions(TERMS.map((name) => [t(`page.glossary.${name}.term`), t(`page.glossary.${name}.meaning`)])),
  );
}
