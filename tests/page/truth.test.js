// live/panels/truth: edits of a truth, the ranges of its sliders, and the order in which edits reach the session;
// widgets/truth-differences.js: what is named as a difference.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import * as edits from '../../frontend/live/panels/truth/truth-edits.js';
import * as scales from '../../frontend/live/panels/truth/truth-scales.js';
import {TruthSource} from '../../frontend/live/panels/truth/truth-source.js';
import {AS_MODEL, complete, differences, perRoot, sentences} from '../../frontend/widgets/truth-differences.js';
import {position, value} from '../../frontend/widgets/slider-scale.js';
import {randomNumbers} from './helpers.js';

/** @import {Edit, Truth} from '../../frontend/live/panels/truth/truth-edits.js' */
/** @import {Plant} from '../../frontend/pages/types.js' */

/** @param {Edit[]} steps */
const after = (...steps) => steps.reduce((truth, step) => step(truth), complete(null));

const PLANT = /** @type {Plant} */ (
  /** @type {unknown} */ ({
    time: {kind: 'continuous'},
    states: [{name: 'x1', unit: 'm'}],
    inputs: [{name: 'u'}],
    outputs: [{name: 'y'}],
    parameters: [{name: 'a', unit: '1/s'}],
    signals: [],
    channels: [{name: 'z'}],
    definitions: [],
    algebraic: [],
    references: [],
  })
);

/** Every edit of a field, and the one that takes it back. @type {[string, Edit, Edit][]} */
const THERE_AND_BACK = [
  ['deviation', edits.setDeviation(0.02), edits.setDeviation(0)],
  ['parameter', edits.setParameter('a', 2, 1), edits.setParameter('a', 1, 1)],
  ['parameter, by its button', edits.setParameter('a', 2, 1), edits.setParameter('a', null, 1)],
  ['process noise', edits.setProcessNoise('x1', 0.1), edits.setProcessNoise('x1', 0)],
  ['correlation', edits.setSensor('y', 'correlation', 2, 0.1), edits.setSensor('y', 'correlation', null, 0.1)],
  ['period', edits.setSensor('y', 'period', 2, 0.1), edits.setSensor('y', 'period', null, 0.1)],
  ['missing', edits.setSensor('y', 'missing', 0.2, 0.1), edits.setSensor('y', 'missing', 0, 0.1)],
  ['jitter', edits.setSensor('y', 'jitter', 0.2, 0.1), edits.setSensor('y', 'jitter', 0, 0.1)],
  ['adds', edits.setSensor('y', 'adds', 'x1', 0.1), edits.setSensor('y', 'adds', null, 0.1)],
  ['dynamics', edits.setDynamics('x1', '-x1'), edits.setDynamics('x1', ' ')],
  ['further state', edits.addState('z'), edits.removeState('z')],
];

for (const [name, there, back] of THERE_AND_BACK)
  test(`${name}: one difference, and none after it is taken back`, () => {
    assert.equal(differences(after(there), PLANT).length, 1);
    assert.deepEqual(after(there, back), AS_MODEL);
  });

test('all edits together are counted one by one, and each can be taken back without the others', () => {
  const all = THERE_AND_BACK.filter(([name]) => name !== 'parameter');
  const whole = after(...all.map(([, there]) => there));
  assert.equal(differences(whole, PLANT).length, all.length);
  for (const [, , back] of all) assert.equal(differences(back(whole), PLANT).length, all.length - 1);
});

test('a parameter that equals the model is named where the others differ', () => {
  assert.deepEqual(after(edits.setDeviation(0.1), edits.setParameter('a', 1, 1)).parameters, {a: 1});
  assert.deepEqual(after(edits.setParameter('a', 1, 1)).parameters, {});
});

test('a shorter period shortens the jitter to less than itself, on the grid of the step', () => {
  const truth = after(edits.setSensor('y', 'jitter', 0.9, 0.1), edits.setSensor('y', 'period', 0.3, 0.1));
  assert.deepEqual([truth.outputs.y.period, truth.outputs.y.jitter], [0.3, 0.2]);
});

test('the equation and the noise of a further state follow its name', () => {
  const truth = after(
    edits.addState('z'),
    edits.setDynamics('z', '-z'),
    edits.setProcessNoise('z', 1),
    edits.changeState('z', {name: 'pump', initial: 3}),
  );
  assert.deepEqual(truth.states, [{name: 'pump', initial: 3, unit: '', description: ''}]);
  assert.deepEqual([truth.dynamics, truth.process_noise], [{pump: '-z'}, {pump: 1}]);
});

test('the name of a further state is free in the plant and in the truth', () => {
  assert.equal(edits.freeName(PLANT, complete(null)), 'z2'); // a fault channel is called z
  assert.equal(edits.freeName(PLANT, after(edits.addState('z2'))), 'z3');
});

test('an experiment that starts again has the truth from its beginning, its other commands and its faults', () => {
  const spec = /** @type {Parameters<typeof edits.withTruth>[0]} */ (
    /** @type {unknown} */ ({
      truth: AS_MODEL,
      faults: [{shape: 'step'}],
      commands: [
        {command: 'set-truth', at: 1},
        {command: 'set-gain', at: 2},
      ],
    })
  );
  const truth = after(edits.setDeviation(0.1));
  assert.deepEqual(edits.withTruth(spec, truth), {...spec, truth, commands: [{command: 'set-gain', at: 2}]});
});

test('a refusal is about the row of its field, over the socket and over REST', () => {
  const fields = {
    'truth.outputs.y.period': 'outputs.y.period',
    'spec.truth.states[0].name': 'states.0.name',
    'commands[3].truth.dynamics.x1': 'dynamics.x1',
    'truth.parameters.truth': 'parameters.truth',
    '': '',
  };
  for (const [field, path] of Object.entries(fields)) assert.equal(edits.pathOf({field, value: 1}), path);
  assert.equal(edits.pathOf({field: 'truth.dynamics', value: 'z'}), 'dynamics.z'); // a state without equation
});

test('truths are compared by what they hold, not by the order in which it was set', () => {
  const [a, b] = [edits.setProcessNoise('x1', 1), edits.setProcessNoise('x2', 2)];
  assert.ok(edits.same(after(a, b), after(b, a)));
  assert.ok(!edits.same(after(a), after(b)));
  assert.ok(edits.sameStates(after(a), after(b)) && !edits.sameStates(after(a), after(edits.addState('z'))));
});

test('sliders are within bounds and set what they show, whatever the unit', () => {
  const random = randomNumbers(4);
  for (let turn = 0; turn < 300; turn += 1) {
    const size = 10 ** (24 * random() - 12);
    const model = random() < 0.1 ? 0 : size * (random() < 0.5 ? 1 : -1);
    const low = random() < 0.5 ? null : model - size * random();
    const high = random() < 0.5 ? null : model + size * random();
    const parameter = scales.parameterScale(model, [low, high]);
    assert.ok(parameter.min >= (low ?? -Infinity) && parameter.max <= (high ?? Infinity));
    assert.ok(parameter.min <= model && model <= parameter.max && parameter.min < parameter.max);
    const noise = scales.noiseScale(size, 10 ** (8 * random() - 4));
    for (const scale of [parameter, noise]) {
      const there = value(scale, 640);
      assert.ok(Math.abs(position(scale, there) - 640) <= 5, `${there} of ${JSON.stringify(scale)}`);
    }
    assert.equal(value(noise, 0), 0);
  }
});

test('the size of a state is declared, else its range so far, else from its domain, else from its value', () => {
  const state = {name: 'x', unit: '', initial: 4, description: '', scale: null, domain: [null, null]};
  /** @param {object} more @param {number} min @param {number} max */
  const size = (more, min, max) =>
    scales.sizeOf(/** @type {Parameters<typeof scales.sizeOf>[0]} */ ({...state, ...more}), {min, max});
  assert.equal(size({scale: 7}, 0, 3), 7);
  assert.equal(size({}, 0, 3), 3);
  assert.equal(size({domain: [0, 50]}, 4, 4), 5);
  assert.equal(size({}, NaN, NaN), 0.4);
  assert.equal(size({initial: 0}, 0, 0), 1);
});

test('an experiment is as the model, differs, or was changed during the run: nothing, a sentence, a second one', () => {
  const truth = after(edits.setDeviation(0.1));
  const change = {command: 'set-truth', at: 3, truth: AS_MODEL};
  /** @param {Truth} first @param {object[]} commands */
  const said = (first, ...commands) =>
    sentences(/** @type {Parameters<typeof sentences>[0]} */ ({truth: first, commands}), PLANT).map(
      (words) => words.split('(')[0], // without a catalogue, the code and its arguments
    );
  assert.deepEqual(said(complete(null)), []);
  assert.deepEqual(said(truth, {command: 'set-gain', at: 1}), ['page.truth.sentence']);
  assert.deepEqual(said(truth, change), ['page.truth.sentence', 'page.truth.changed']);
  assert.deepEqual(said(complete(null), change), ['page.truth.changed']);
});

test('the unit of process noise is that of the state per root of a second', () => {
  assert.deepEqual(['cm', '', 'rad/s'].map(perRoot), ['cm/√s', '1/√s', '(rad/s)/√s']);
});

/**
 * A source with a session that answers on demand. Several turns of timers follow an answer, as the source begins one of
 * its own in the first of them.
 */
function withSession() {
  /** @type {{truth: Truth, answer: (error?: object) => Promise<void>}[]} */
  const sent = [];
  /** @type {[string, unknown][]} */
  const refused = [];
  const source = new TruthSource({
    pause: 0,
    changed() {},
    refused: (path, error) => refused.push([path, error]),
    send: (truth) =>
      new Promise((done, fail) =>
        sent.push({
          truth,
          async answer(error) {
            if (error) fail(error);
            else done(null);
            for (let turn = 0; turn < 4; turn += 1) await new Promise((next) => setTimeout(next, 2));
          },
        }),
      ),
  });
  return {source, sent, refused};
}

test('edits reach the session one after another, of a dragged slider the newest, and none is lost', async () => {
  const {source, sent} = withSession();
  source.change('deviation', edits.setDeviation(0.01));
  source.change('process_noise.x1', edits.setProcessNoise('x1', 1));
  source.change('process_noise.x1', edits.setProcessNoise('x1', 2));
  assert.equal(differences(source.shown, PLANT).length, 2);
  await sent[0].answer();
  assert.deepEqual(sent.at(-1)?.truth, after(edits.setDeviation(0.01), edits.setProcessNoise('x1', 2)));
  await sent[1].answer();
  assert.deepEqual([sent.length, source.shown], [2, sent[1].truth]);
});

test('a refused edit is reported at its field and is not in what is sent next', async () => {
  const {source, sent, refused} = withSession();
  source.change('dynamics.x1', edits.setDynamics('x1', 'nope'));
  source.change('deviation', edits.setDeviation(0.01));
  await sent[0].answer({field: 'truth.dynamics.x1'});
  assert.deepEqual(
    refused.map(([path]) => path),
    ['dynamics.x1'],
  );
  assert.deepEqual(sent[1].truth, after(edits.setDeviation(0.01)));
});

test('older facts do not take back an edit that is on its way, newer ones of another viewer are shown', async () => {
  const {source, sent} = withSession();
  source.change('deviation', edits.setDeviation(0.01));
  source.follow(complete(null));
  assert.equal(source.shown.deviation, 0.01);
  await sent[0].answer();
  assert.equal(source.shown.deviation, 0.01);
  source.follow(after(edits.setDeviation(0.03)));
  assert.equal(source.shown.deviation, 0.03);
});

test('further states make a draft, which is not sent; without them its other edits are', async () => {
  const {source, sent} = withSession();
  source.change('states.0', edits.addState('z'));
  source.change('deviation', edits.setDeviation(0.01));
  assert.equal(sent.length, 0);
  assert.equal(source.draft?.states.length, 1);
  source.change('states.0', edits.removeState('z'));
  assert.equal(source.draft, null);
  assert.deepEqual(sent[0].truth, after(edits.setDeviation(0.01)));
  source.change('states.0', edits.addState('z'));
  source.discard();
  assert.equal(source.shown.states.length, 0);
});

test('an answer to the session before changes nothing', async () => {
  const {source, sent} = withSession();
  source.change('deviation', edits.setDeviation(0.01));
  source.reset(after(edits.setDeviation(0.2)));
  await sent[0].answer();
  assert.equal(source.shown.deviation, 0.2);
});
