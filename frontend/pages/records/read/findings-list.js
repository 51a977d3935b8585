// The list of peculiarities of a record, numbered as the marks in the picture; pointing at either lights both.

import {h} from '../../../common/dom.js';
import {say, t} from '../../../i18n/words.js';
import {sentence} from '../sentence.js';
import {link} from '../../../widgets/controls.js';
import {refusalCard} from '../refusal.js';
import {isProposal, withProposal} from '../mapping.js';
import {timeUnitWords} from './columns.js';

/** @import * as service from '../../../types/service.js' */
/** @import {RecordActions, RecordState} from '../types.js' */

/**
 * The card with the findings, or with the refusal in their place.
 * @param {RecordState} state
 * @param {RecordActions} act
 */
export function findingsCard(state, act) {
  const {inspection} = state;
  if (state.problem) return refusalCard(state);
  if (!inspection) return null;
  const {findings, checked} = inspection;
  return h(
    'section',
    {class: 'card', id: 'found'},
    h(
      'div',
      {class: 'heading'},
      h('h2', {}, t('page.records.found')),
      h('span', {class: 'soft aside'}, t('page.records.nothing-computed')),
    ),
    inspection.problem &&
      h(
        'div',
        {class: 'problem', role: 'alert'},
        h('b', {}, t('page.records.not-ready')),
        h('p', {}, sentence(inspection.problem), remedyOf(inspection.problem)),
      ),
    findings.length === 0
      ? h('p', {}, t('page.records.found.nothing'))
      : h(
          'ol',
          {class: 'peculiar'},
          findings.map((one, place) => entry(one, place + 1, inspection, act)),
        ),
    checked.length > 0 && [
      h('p', {class: 'soft checked-head'}, t('page.records.checked')),
      h(
        'ul',
        {class: 'checked'},
        checked.map((one) => h('li', {}, say(one))),
      ),
    ],
  );
}

/** @param {service.Text} problem */
function remedyOf({code, args}) {
  const words = say({code: `${code}.remedy`, args: /** @type {{[name: string]: never}} */ (args), text: ''});
  return words && [' ', h('span', {class: 'remedy'}, sentence(words))];
}

/**
 * @param {service.RecordFinding} finding
 * @param {number} sign
 * @param {service.RecordInspection} inspection
 * @param {RecordActions} act
 */
function entry({id, severity, text, treatment, proposal}, sign, {mapping}, act) {
  return h(
    'li',
    {class: severity, tabindex: 0, 'data-finding': id},
    h('span', {class: 'sign', 'aria-hidden': 'true'}, sign),
    h(
      'div',
      {},
      h('b', {}, sentence(text).replace(/[.。]$/u, '')),
      treatment && h('p', {class: 'soft'}, sentence(treatment)),
      isProposal(proposal) && link(proposalWords(proposal), () => act.map(withProposal(mapping, proposal))),
    ),
  );
}

/** @param {import('../mapping.js').Proposal} proposal */
function proposalWords({time, quantities = {}}) {
  const [[name, one] = ['', {}]] = Object.entries(quantities);
  if (name && one.unit) return t('page.records.remedy.unit', {name, unit: one.unit});
  if (time?.unit) return t('page.records.remedy.time', {unit: timeUnitWords(time.unit)});
  return t('page.records.proposal');
}

/**
 * Light the finding that is pointed at or focused, in the list and in the picture.
 * @param {HTMLElement} root
 */
export function lightTogether(root) {
  /** @param {Event} event */
  const show = ({target, type}) => {
    const id = target instanceof Element ? target.closest('[data-finding]')?.getAttribute('data-finding') : null;
    const lit = type === 'pointerout' || type === 'focusout' ? null : id;
    for (const one of root.querySelectorAll('[data-finding]'))
      one.classList.toggle('lit', one.getAttribute('data-finding') === lit);
  };
  for (const type of ['pointerover', 'pointerout', 'focusin', 'focusout']) root.addEventListener(type, show);
  root.addEventListener('click', ({target}) => {
    const mark = target instanceof Element ? target.closest('button.mark') : null;
    const entries = [...root.querySelectorAll('li[data-finding]')];
    const item = entries.find((one) => one.getAttribute('data-finding') === mark?.getAttribute('data-finding'));
    if (mark && item instanceof HTMLElement) item.focus();
  });
}
