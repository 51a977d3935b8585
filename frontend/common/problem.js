// A refusal, in place: which field, what arrived, what is wrong with it, what to do.

import {h} from './dom.js';
import {text} from '../i18n/pages.js';

const titleOf = (problem) =>
  problem.status === 422
    ? text.refused
    : problem.status === 404
      ? text.notFound
      : text.said(problem.title) || text.failed;

/** The block for what no field of the form can show; `errors` are those of the problem that are left. */
export function problemBlock(problem, errors = problem.errors) {
  const detail = problem.errors.length ? null : h('p', {}, closed(text.said(problem.detail)));
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
      sentence(error),
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

/** What is wrong and the remedy, as two short sentences. */
export function sentence(error) {
  return [
    closed(text.said(error.problem)),
    ' ',
    h('span', {class: 'remedy'}, closed(`${text.remedy}: ${text.said(error.remedy)}`)),
  ];
}

/** A sentence with a capital and a full stop. */
const closed = (words) => words && `${words[0].toUpperCase()}${words.slice(1)}${/[.?!]$/.test(words) ? '' : '.'}`;
