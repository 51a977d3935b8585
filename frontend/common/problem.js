// A refusal beside the form: the field, the value that arrived, the problem and the remedy.

import {h} from './dom.js';
import {asSentence, refusalWords, say, t} from '../i18n/words.js';

/** @import * as service from '../types/service.js' */
/** @import {Problem} from './api.js' */

/** @param {Problem} problem */
const titleOf = (problem) =>
  problem.status === 422
    ? t('page.problem.invalid')
    : problem.status === 404
      ? t('page.problem.not-found')
      : say(problem.title) || t('page.problem.failed');

/**
 * The block for errors that no field of the form can show; `errors` are those of the problem that are left.
 * @param {Problem} problem
 * @param {service.FieldError[]} [errors]
 */
export function problemBlock(problem, errors = problem.errors) {
  const detail = problem.errors.length ? null : h('p', {}, asSentence(problem.detail));
  const rows = errors.map((error) =>
    h(
      'li',
      {},
      h(
        'code',
        {},
        error.field + (error.value === undefined || error.value === null ? '' : ` = ${JSON.stringify(error.value)}`),
      ),
      ' ',
      explained(error),
    ),
  );
  return h(
    'div',
    {class: 'problem', role: 'alert'},
    h('b', {}, titleOf(problem)),
    detail,
    rows.length ? h('ul', {}, rows) : null,
  );
}

/**
 * The problem and its remedy, as two short sentences.
 * @param {unknown} error   a refusal
 */
export function explained(error) {
  const {problem, remedy} = refusalWords(error);
  return [asSentence(problem), ' ', h('span', {class: 'remedy'}, t('page.text.remedy', {remedy: asSentence(remedy)}))];
}
