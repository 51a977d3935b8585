// The errata of a paper: what is printed, what is used, why; and a button that replays the evidence.

import {reason} from '../../../common/api.js';
import {fill, h} from '../../../common/dom.js';
import {named, t} from '../../../i18n/words.js';
import {withSymbols} from '../../../widgets/prose.js';
import {computedFigure} from './figures.js';
import {showValue} from './numbers.js';
import {measuredIn} from './results.js';

/** @import * as service from '../../../types/service.js' */

/** @param {readonly service.Erratum[]} errata */
export const errataTable = (errata) =>
  h(
    'ol',
    {class: 'papers-errata'},
    errata.map((one) => {
      const shown = h('div', {class: 'papers-evidence', hidden: true});
      return h(
        'li',
        {},
        h(
          'p',
          {class: 'papers-printed'},
          h('span', {class: 'soft'}, t('page.papers.printed')),
          ' ',
          withSymbols(named(one.printed)),
        ),
        h('p', {}, h('span', {class: 'soft'}, t('page.papers.used')), ' ', withSymbols(named(one.used))),
        h('p', {class: 'papers-reason'}, withSymbols(named(one.reason))),
        one.evidence ? replay(one.evidence, shown) : h('p', {class: 'soft'}, t('page.papers.by-reading')),
        shown,
      );
    }),
  );

/** @param {service.Evidence} evidence @param {HTMLElement} shown */
function replay(evidence, shown) {
  const button = h(
    'button',
    {
      type: 'button',
      class: 'quiet',
      'aria-expanded': 'false',
      onclick: () => {
        shown.hidden = !shown.hidden;
        button.setAttribute('aria-expanded', String(!shown.hidden));
        if (!shown.childElementCount) fill(shown, contents(evidence));
      },
    },
    t('page.papers.replay'),
  );
  return h('p', {class: 'papers-actions'}, button);
}

/** @param {service.Evidence} evidence */
function contents({experiment, figure, numbers}) {
  const values = numbers.map(() => h('b', {}, '…'));
  if (numbers.length)
    measuredIn(numbers).then(
      (found) => found.forEach((value, place) => showValue(values[place], numbers[place], value)),
      (error) => values.forEach((cell) => fill(cell, reason(error).message)),
    );
  return [
    numbers.length > 0 &&
      h(
        'ul',
        {},
        numbers.map((one, place) => h('li', {}, withSymbols(named(one.what)), ' ', values[place])),
      ),
    computedFigure(experiment, figure),
    h('p', {}, h('a', {href: `/?experiment=${encodeURIComponent(experiment)}`}, t('page.papers.watch'))),
  ];
}
