"""Kernels against C written by hand, one run and batches: ``python -m benchmarks.kernels``. One thread throughout."""

import argparse
from dataclasses import replace

import numpy as np

from backend.engine import faults
from backend.engine.batch import run_batch, with_seed
from backend.engine.kernel import Layout, kernel
from backend.engine.graph import variables
from backend.engine.grid import cut
from backend.engine.simulation import Experiment, Tables, joined
from benchmarks.measure import line, ratio, rounds
from benchmarks.problem import ByHand, engine, rows, start

SINGLE_BOUND, SEEDS_BOUND, EVERYTHING_BOUND = 1.0, 0.07, 0.25


def kernels_alone(e: Experiment):
    """A call of the compiled plant and observer over the whole horizon, its tables laid out before."""
    program = joined(e.plant, e.estimators[0].program)
    signals = e.signals | {"noise.y.y": e.measurement.noises[0]}
    breaks = np.concatenate([s.breaks(0.0, e.steps * e.step) for s in signals.values()])
    grid = cut(0, e.steps, e.step, breaks, e.every, 1)
    tables = Tables(grid, signals, 4)
    held, staged = tables.divide(variables(program.graph, program.update))
    layout = Layout(held=held, staged=staged)
    values = e.parameters | e.estimators[0].parameters
    params, table = np.array([values[p] for p in layout.shared_params(program)]), tables.held(held)
    run, out = kernel(program, layout), np.empty((e.steps // e.every, 19))
    from backend.engine.simulation import Simulation

    s = Simulation(e).initial()
    begin = np.concatenate([s.plant, s.observers[0]])

    def call() -> np.ndarray:
        run(grid.segments, begin.copy(), params, e.every, out, held=table)
        return out

    return call, program.states


def single(by_hand: ByHand) -> str:
    e = engine()
    inputs, state = rows(e), start(e)
    call, names = kernels_alone(e)
    picked = [names.index(n) for n in ("x.x1", "xh.x1", "xh.x2", "thetah.theta1", "thetah.theta2", "thetah.theta3")]
    ours, theirs = call()[:, picked], by_hand.simulate(inputs, e.steps, e.step, e.every, state)[:, [0, 14, 15, 16, 17, 18]]
    assert np.abs(ours - theirs).max() < 1e-10, "the two do not compute the same"
    seconds = rounds({"kernel": call, "C": lambda: by_hand.simulate(inputs, e.steps, e.step, e.every, state)}, 31)
    return line("one run, 100 s at 1 ms: kernels / C", ratio(seconds, "kernel", "C"), f"≤ {SINGLE_BOUND}, failure > 1.2")


def varied(base: Experiment, i: int, runs: int) -> Experiment:
    """Run i of a batch in which seed, parameters, gains, starts and fault sizes all differ."""
    e, share = with_seed(base, i), i / runs
    estimator = e.estimators[0]
    numbers = estimator.parameters | {"g.rho": 4 + share, "g.lambda": 3.5 + share, "m.a4": 0.1 + 0.01 * share,
                                      "x0.x1": 0.08 * share, "x0.x2": 0.02 * share}  # fmt: skip
    signals = dict(e.signals)
    for name, onset, size in (("theta3", 20.0, 0.02), ("theta1", 40.0, 0.01), ("theta2", 70.0, 0.015)):
        fault = {"channel": name, "shape": "step", "onset": onset, "end": None, "size": size * (0.5 + share)}
        signals[f"theta.{name}"] = faults.theta(name, [fault], 0)
    return replace(e, parameters=e.parameters | {"p.a4": 0.1 + 0.01 * share}, x0=e.x0 * (1 + 0.1 * share), signals=signals,
                   estimators=(replace(estimator, parameters=numbers),))  # fmt: skip


def batches(by_hand: ByHand, runs: int, count: int) -> list[str]:
    base = engine(record=1.0)
    inputs, state = rows(base), start(base)
    seeds = [with_seed(base, i) for i in range(runs)]
    differing = [varied(base, i, runs) for i in range(runs)]
    some = range(0, 32)  # the scalar code's time is proportional to the number of runs

    def scalar() -> None:
        by_hand.batch(inputs, base.step, base.every, state, some, 0.001)

    seconds = rounds({"seeds": lambda: run_batch(seeds), "everything": lambda: run_batch(differing), "C": scalar}, count)
    share = len(some) / runs
    scaled = {k: [t * (1 if k == "C" else share) for t in v] for k, v in seconds.items()}
    return [
        line(f"{runs} runs, seeds differ (noise included): a run / C", ratio(scaled, "seeds", "C"), f"≤ {SEEDS_BOUND}"),
        line(f"{runs} runs, everything differs: a run / C", ratio(scaled, "everything", "C"), f"≤ {EVERYTHING_BOUND}"),
    ]


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--runs", type=int, default=1024)
    arguments.add_argument("--rounds", type=int, default=7)
    given = arguments.parse_args()
    by_hand = ByHand.compiled()
    print(single(by_hand), flush=True)
    print("\n".join(batches(by_hand, given.runs, given.rounds)))


if __name__ == "__main__":
    main()
