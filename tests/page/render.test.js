// The page's renderer gives what the server's gives: both are held to tests/messages/rendering.json.

import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

import {Catalogue, formatted} from '../../frontend/i18n/render.js';

/** @param {string} path */
const read = (path) => readFileSync(new URL(`../../${path}`, import.meta.url), 'utf8');
const {rows} = JSON.parse(read('tests/messages/rendering.json'));
/** @type {{[language: string]: string[]}} */
const PLURAL = {en: ['one', 'other'], zh: ['other']};

/**
 * The entries of a gettext file whose strings take one line each.
 * @param {string} path
 */
function entries(path) {
  /** @param {string} text @returns {string} */
  const unquoted = (text) => JSON.parse(`"${text}"`);
  /** @type {{[code: string]: string | string[]}} */
  const found = {};
  for (const entry of read(path).split('\n\n').slice(1)) {
    const [, code = ''] = /^msgid "(.*)"$/m.exec(entry) ?? [];
    const words = [...entry.matchAll(/^msgstr(?:\[\d\])? "(.*)"$/gm)].map((match) => unquoted(match[1]));
    found[code] = entry.includes('msgid_plural') ? words : words[0];
  }
  return found;
}

const common = Object.fromEntries(
  ['en', 'zh'].map((language) => [language, entries(`backend/thetascope/messages/locales/${language}/common.po`)]),
);

for (const {template, args, language, expected} of rows) {
  test(`${JSON.stringify(template)} with ${JSON.stringify(args)} in ${language}`, () => {
    const messages = {...common[language], test: template};
    const catalogue = new Catalogue({language, plural: PLURAL[language], messages});
    assert.equal(catalogue.render({code: 'test', args}), expected);
  });
}

test('a code that nobody knows is shown with its arguments, and is known to be unknown', () => {
  const catalogue = new Catalogue({language: 'en', plural: ['one', 'other'], messages: {}});
  assert.equal(catalogue.render({code: 'a.b', args: {x: 1}}), 'a.b(x=1)');
  assert.equal(catalogue.has('a.b'), false);
  assert.equal(catalogue.has('toString'), false);
});

test('a format that Python does not have is an error, as there', () => {
  assert.throws(() => formatted(1.5, 'abc'), RangeError);
});
