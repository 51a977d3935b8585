// What follows a change of the text: the check after 300 ms, then the trial, then the observers. A newer change ends
// what is still under way.

import {Problem, reason} from '../../common/api.js';
import {t} from '../../i18n/words.js';
import * as service from './service.js';

/** @import {Plant} from '../../types/service.js' */
/** @import {ShopStore} from './types.js' */

const PAUSE = 300; // ms after the last key
const SLIDER = 120;
const RANKING = 600;

/** @param {unknown} error */
export const asProblem = (error) =>
  error instanceof Problem
    ? error
    : new Problem({
        title: t('page.problem.unreadable'),
        detail: t('page.problem.unreadable.remedy', {error: reason(error).message}),
      });

/** The inputs and outputs of a plant: curves of others are not shown beside its text. @param {Plant | null} [plant] */
const signalsOf = (plant) => JSON.stringify([plant?.inputs, plant?.outputs].map((all) => all?.map(({name}) => name)));

/**
 * @param {ShopStore} store
 */
export function followChanges(store) {
  const steps = {check: step(), trial: step(), ranking: step()};

  async function check() {
    await steps.check.run(
      async (signal) => {
        const {text} = store.state;
        const answer = await service.check(text, signal);
        if (store.state.text !== text) return;
        if (answer.valid) {
          const fresh = JSON.stringify(answer.plant) !== JSON.stringify(store.state.good?.plant);
          if (signalsOf(answer.plant) !== signalsOf(store.state.good?.plant)) store.set({trial: null});
          store.set({check: answer, checking: false, good: answer, problem: null});
          if (fresh || store.state.trial === null) {
            store.set({ranking: fresh ? null : store.state.ranking});
            begin(0);
          }
        } else store.set({check: answer, checking: false, problem: null});
      },
      (problem) => store.set({checking: false, problem}),
    );
  }

  /** @param {number} pause */
  function begin(pause) {
    steps.trial.later(pause, trial);
  }

  function body() {
    const {good, tried} = store.state;
    if (!good?.plant) return null;
    const known = new Set([...good.plant.inputs, ...good.plant.references].map(({name}) => name));
    const inputs = Object.fromEntries(Object.entries(tried.inputs).filter(([name]) => known.has(name)));
    return {plant: good.plant, parameters: tried.parameters, initial: tried.initial, inputs};
  }

  async function trial() {
    const asked = body();
    if (!asked) return;
    await steps.trial.run(
      async (signal) => store.set({trial: await service.trial(asked, signal), trialProblem: null}),
      (problem) => store.set({trial: null, trialProblem: problem}),
    );
    steps.ranking.later(RANKING, rank);
  }

  async function rank() {
    const asked = body();
    if (!asked || store.state.trialProblem) return;
    await steps.ranking.run(
      async (signal) => {
        const {observers} = await service.ranking(asked, signal);
        store.set({ranking: observers});
      },
      () => store.set({ranking: []}),
    );
  }

  store.subscribe(
    (state) => state.text,
    () => {
      store.set({checking: true});
      steps.check.later(PAUSE, check);
    },
  );
  store.subscribe(
    (state) => state.tried,
    () => store.state.good && begin(SLIDER),
  );
  return {now: check};
}

/** One kind of work, of which only the last is wanted. */
function step() {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @type {AbortController | null} */
  let running = null;
  return {
    /** @param {number} pause @param {() => unknown} work */
    later(pause, work) {
      clearTimeout(timer);
      timer = setTimeout(work, pause);
    },
    /**
     * @param {(signal: AbortSignal) => Promise<unknown>} work
     * @param {(problem: Problem) => void} failed
     */
    async run(work, failed) {
      running?.abort();
      const mine = new AbortController();
      running = mine;
      try {
        await work(mine.signal);
      } catch (error) {
        if (!mine.signal.aborted) failed(asProblem(error));
      }
    },
  };
}
