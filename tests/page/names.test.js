// common/names.js: names as symbols or words, and the badges of channels.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {badges, capital, plain, split, symbolic} from '../../frontend/common/names.js';

test('a Greek or single letter with an index is a symbol, everything else a word', () => {
  for (const [name, parts, text, isSymbol] of /** @type {[string, [string, string], string, boolean][]} */ ([
    ['theta1', ['θ', '1'], 'θ₁', true],
    ['theta_12', ['θ', '12'], 'θ₁₂', true],
    ['x', ['x', ''], 'x', true],
    ['Omega', ['Ω', ''], 'Ω', true],
    ['k_max', ['k', 'max'], 'k_max', false],
    ['level1', ['level1', ''], 'level1', false],
    ['gain_loss', ['gain loss', ''], 'gain loss', false],
    ['constructor', ['constructor', ''], 'constructor', false],
  ])) {
    assert.deepEqual([split(name), plain(name), symbolic(name)], [parts, text, isSymbol], name);
  }
});

test('every channel of a plant has a badge of its own, of three characters at most', () => {
  for (const names of [
    ['theta1', 'theta2', 'theta3'],
    ['gain_loss', 'load_torque', 'friction_increase', 'current_bias', 'speed_bias'],
    ['leak1', 'leak2', 'level1', 'level2', 'clog13'],
    ['friction', 'y1', 'gain_loss'],
    ['a', 'b1', 'b2'],
  ]) {
    const found = badges(names.map((name) => ({name})));
    assert.deepEqual([...found.keys()].sort(), [...names].sort());
    const written = [...found.values()].map((parts) => parts.join(''));
    assert.equal(new Set(written).size, names.length, written.join());
    assert.ok(
      written.every((text) => text.length > 0 && text.length <= 4),
      written.join(),
    );
  }
});

test('a sentence begins with a capital, a symbol stays as it is', () => {
  assert.deepEqual(
    [capital('leak in tank 1'), capital('θ₁ is active'), capital('x is active'), capital('')],
    ['Leak in tank 1', 'θ₁ is active', 'X is active', ''],
  );
});
