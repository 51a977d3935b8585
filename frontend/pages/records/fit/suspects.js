// What would explain a misfit, the likeliest first, each with its remedy as a button; and what would help otherwise.

import {h, number} from '../../../common/dom.js';
import {t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {remedyFor} from './remedy.js';

/** @import * as service from '../../../types/service.js' */
/** @import {Remedy} from './remedy.js' */
/** @import {Diagnosis, RecordActions, RecordState} from '../types.js' */

const MOST = 6;

/**
 * The remedies of a diagnosis's suspects, the likeliest first; null where the page has none.
 * @param {RecordState} state
 * @param {Diagnosis} diagnosis
 * @returns {(Remedy | null)[]}
 */
export function remedies({inspection}, {fit}) {
  if (!inspection) return [];
  const {mapping, quantities} = inspection;
  const fitted = new Set(fit.parameters.map(({name}) => name));
  return fit.suspects.map((one) =>
    one.kind === 'parameter' && fitted.has(one.name) ? null : remedyFor(one, {mapping, quantities}),
  );
}

/** @param {Remedy} remedy */
export const remedyWords = ({code, args}) => t(code, args);

/**
 * @param {RecordState} state
 * @param {Diagnosis} diagnosis
 * @param {RecordActions} act
 */
export function suspectsCard(state, diagnosis, act) {
  const {suspects, advice, verdict} = diagnosis.fit;
  if (suspects.length === 0 && advice.length === 0) return null;
  const all = remedies(state, diagnosis);
  const misfit = verdict === 'does-not-fit';
  const most = Math.max(...suspects.map((one) => one.gain));
  return [
    suspects.length > 0 &&
      h(
        'section',
        {class: 'card'},
        h('h2', {}, t('page.records.blame')),
        h(
          'ol',
          {class: 'suspects'},
          suspects
            .slice(0, MOST)
            .map((one, place) =>
              h(
                'li',
                {},
                h('p', {class: place === 0 ? 'strong' : ''}, sentence(one.text)),
                h(
                  'div',
                  {class: 'suspect-line'},
                  h(
                    'span',
                    {class: 'gain', title: t('page.records.blame.gain', {gain: number(one.gain, 3)})},
                    h('i', {style: `width:${(100 * one.gain) / most}%`}),
                  ),
                  remedyButton(all[place], act),
                ),
              ),
            ),
        ),
      ),
    misfit &&
      h(
        'section',
        {class: 'card'},
        h('h2', {}, t('page.records.why-none')),
        h('p', {}, t('page.records.why-none.text')),
      ),
    advice.length > 0 &&
      h(
        'section',
        {class: 'card'},
        h('h2', {}, misfit ? t('page.records.otherwise') : t('page.records.advice')),
        h(
          'ul',
          {class: 'advice'},
          advice.map((one) => h('li', {}, sentence(one))),
        ),
      ),
  ];
}

/** @param {Remedy | null} remedy @param {RecordActions} act */
const remedyButton = (remedy, act) =>
  remedy && h('button', {type: 'button', class: 'quiet', onclick: () => applyRemedy(remedy, act)}, remedyWords(remedy));

/** @param {Remedy} remedy @param {RecordActions} act */
export const applyRemedy = ({mapping, parameters}, act) => act.diagnose({mapping, parameters});
