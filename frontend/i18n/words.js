// The words of the page: codes with arguments, rendered with the catalogue of one language, which comes from the
// server.

import {get} from '../common/api.js';
import {Catalogue} from './render.js';

/** @type {Catalogue} */
let catalogue = new Catalogue({language: 'en', plural: ['one', 'other'], messages: {}});

/**
 * Load the words of a language; from then on `t` and `say` use them.
 * @param {import('./language.js').Language} language
 */
export async function speak(language) {
  catalogue = new Catalogue(await get(`/api/messages/${language}`));
  document.documentElement.lang = language === 'zh' ? 'zh-CN' : language;
}

/** The language that is spoken. */
export const language = () => catalogue.language;

/**
 * The words of a code: t('page.transport.play'), t('page.plant.states', {n: 3}).
 * @param {string} code
 * @param {Record<string, import('./render.js').Argument>} args
 */
export const t = (code, args = {}) => catalogue.render({code, args});

/** Whether there are words for a code. @param {string} code */
export const hasWords = (code) => catalogue.has(code);

/**
 * A message of the server, {code, args, text}, in the page's language; its text only where the code is unknown here.
 * A plain text stays as it is.
 * @param {import('./render.js').Message | import('../types/service.js').Text | string | null | undefined} message
 * @returns {string}
 */
export function say(message) {
  if (message === null || message === undefined) return '';
  if (typeof message === 'string') return message;
  const said = /** @type {import('./render.js').Message} */ (message); // the arguments that came over the wire
  return catalogue.has(said.code) ? catalogue.render(said) : (said.text ?? said.code);
}

/**
 * A refusal or another error, as far as it has these.
 * @typedef {object} Refusal
 * @property {string} [code]
 * @property {Record<string, import('./render.js').Argument>} [args]
 * @property {string} [problem]
 * @property {string} [detail]
 * @property {string} [message]
 * @property {string} [remedy]
 */

/**
 * Prose of a plant or an experiment in the page's language: a text, or a map from language to text.
 * @param {string | {[language: string]: string} | {en: string; zh: string} | null | undefined} prose
 * @returns {string}
 */
export function named(prose) {
  if (!prose || typeof prose !== 'object') return prose ?? '';
  const texts = /** @type {{[language: string]: string}} */ (prose);
  return texts[language()] || texts.en || Object.values(texts).find(Boolean) || '';
}

/**
 * A message of the server as a sentence, with a capital letter and a full stop.
 * @param {Parameters<typeof say>[0]} message
 */
export function asSentence(message) {
  const words = say(message);
  if (words === '') return '';
  return `${words[0].toUpperCase()}${words.slice(1)}${/[.?!。？！]$/.test(words) ? '' : t('page.text.stop')}`;
}

/**
 * The problem and the remedy of a refusal, or of another error, in the page's language: by its code, else as the
 * server has worded them.
 * @param {unknown} error   as thrown
 * @returns {{problem: string, remedy: string}}
 */
export function refusalWords(error) {
  const {code = '', args = {}, problem, detail, message, remedy = ''} = /** @type {Refusal} */ (error ?? {});
  if (!catalogue.has(code)) return {problem: say(problem ?? detail ?? message), remedy: say(remedy)};
  const own = args.remedy;
  const other = own && typeof own === 'object' && 'code' in own ? own : {code: `${code}.remedy`, args};
  return {problem: t(code, args), remedy: catalogue.has(other.code) ? catalogue.render(other) : say(remedy)};
}
