// Let the time of a step pass: what the student chose, then its seconds, so fast that it takes a few seconds here.

/** @import {BatchCommand} from '../types.js' */
/** @import {Lesson} from './lesson.js' */

const SHOWN = 6; // s that a step takes on the clock of the wall
const FASTEST = 1000;

/**
 * Run the step and return the observer whose divergence has stopped it, if the step explains one.
 * @param {Lesson} lesson
 * @param {() => boolean} wanted   whether the step is still the one that is shown
 * @returns {Promise<{label: string, t: number} | null>}
 */
export async function playStep(lesson, wanted) {
  const {app, step, view} = lesson;
  const commands = commandsOf(lesson);
  if (commands.length) await app.act.together(commands);
  const seconds = step.run?.seconds ?? 0;
  const end = view.mark + seconds;
  const before = new Set(app.state.log.map(({row, kind, subject}) => `${row} ${kind} ${subject}`));
  const fallen = () =>
    step.cause
      ? app.state.log.find(
          ({row, kind, subject}) => kind === 'diverged' && subject && !before.has(`${row} ${kind} ${subject}`),
        )
      : undefined;
  const over = () => app.samples.now >= end - app.state.record / 2 || app.state.ended || fallen() || !wanted();
  if (matchMedia('(prefers-reduced-motion: reduce)').matches) {
    await app.act.step(Math.max(1, Math.round((end - app.samples.now) / app.state.record)));
  } else {
    await app.act.speed(Math.min(FASTEST, Math.max(1, Number((seconds / SHOWN).toPrecision(2)))));
    await app.act.play();
  }
  await passed(app, over);
  if (app.state.playing && wanted()) await app.act.pause();
  const event = fallen();
  return event ? {label: event.subject, t: event.t} : null;
}

/**
 * What the student chose, as commands, and those of the step.
 * @param {Lesson} lesson
 */
function commandsOf({step, view}) {
  /** @type {BatchCommand[]} */
  const commands = [];
  if (step.dial?.observer && step.dial.gain && view.dial !== null)
    commands.push({type: 'set-gain', observer: step.dial.observer, gain: step.dial.gain, value: view.dial});
  if (step.choices?.length && view.chosen !== null) commands.push(...plain(step.choices[view.chosen].do));
  commands.push(...plain(step.run?.do));
  return commands;
}

/** Commands of a lesson; the service has checked them. @param {unknown} commands */
const plain = (commands) => /** @type {BatchCommand[]} */ (commands ?? []);

/** @param {Lesson['app']} app @param {() => unknown} over */
const passed = (app, over) =>
  new Promise((done) => {
    const look = () => (over() ? done(null) : setTimeout(look, 30));
    app.wake();
    look();
  });
