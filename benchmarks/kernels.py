"""Compare the compiled plant and observer with the same Runge–Kutta method in handwritten C: one run, and batches.

Uses one thread.

    python -m benchmarks kernels
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.measure import Figure, ratios, rounds
from benchmarks.problem import ESTIMATES, PLACES, ByHand, engine, kernels_alone, rows, start
from thetascope.engine.inputs import fault_signals
from thetascope.engine.simulation.batch import run_batch, with_seed
from thetascope.engine.simulation.experiment import Experiment

RUNS = 1024
SHARE = 32  # runs of the scalar code per round; its time is proportional to their number


def figures(runs: int = RUNS) -> Iterator[Figure]:
    """Yield the figures of one run and of batches, each relative to handwritten C."""
    by_hand = ByHand.compiled()
    yield single(by_hand)
    yield from batches(by_hand, runs)


def single(by_hand: ByHand, count: int = 41) -> Figure:
    """Compare the kernel of one run with equivalent C. Raises AssertionError if they do not agree to 1e-10."""
    e = engine()
    inputs, state = rows(e), start(e)
    call, names = kernels_alone(e)
    ours = call()[:, [names.index(n) for n in ESTIMATES]]
    theirs = by_hand.simulate(inputs, e.steps, e.step, e.every, state)[:, PLACES]
    if not np.abs(ours - theirs).max() < 1e-10:
        raise AssertionError("kernels and C do not compute the same")
    seconds = rounds({"kernels": call, "C": lambda: by_hand.simulate(inputs, e.steps, e.step, e.every, state)}, count)
    return Figure.of("zhao-2012, 100 s at 1 ms: kernels ÷ C", ratios(seconds, "kernels", "C"), "≤ 1, failure above 1.2")


def varied(base: Experiment, i: int, runs: int) -> Experiment:
    """Return run i of a batch in which seed, parameters, gains, initial states and fault sizes all differ."""
    e, share = with_seed(base, i), i / runs
    estimator = e.estimators[0]
    numbers = estimator.parameters | {
        "g.rho": 4 + share,
        "g.lambda": 3.5 + share,
        "m.a4": 0.1 + 0.01 * share,
        "x0.x1": 0.08 * share,
        "x0.x2": 0.02 * share,
    }
    signals = dict(e.signals)
    for name, onset, size in (("theta3", 20.0, 0.02), ("theta1", 40.0, 0.01), ("theta2", 70.0, 0.015)):
        fault = {"channel": name, "shape": "step", "onset": onset, "end": None, "size": size * (0.5 + share)}
        signals[f"theta.{name}"] = fault_signals.theta(name, [fault], 0)
    return replace(
        e,
        parameters=e.parameters | {"p.a4": 0.1 + 0.01 * share},
        x0=e.x0 * (1 + 0.1 * share),
        signals=signals,
        estimators=(replace(estimator, parameters=numbers),),
    )


def batches(by_hand: ByHand, runs: int, count: int = 7) -> Iterator[Figure]:
    """Compare batches, with noise drawn and states recorded each second; the C code does the same, run after run."""
    base = engine(evaluate=1.0)
    inputs, state = rows(base), start(base)
    seeds = [with_seed(base, i) for i in range(runs)]
    differing = [varied(base, i, runs) for i in range(runs)]

    def scalar() -> None:
        by_hand.batch(inputs, base.step, base.every, state, range(SHARE), 0.001)

    seconds = rounds({"seeds": lambda: run_batch(seeds), "all": lambda: run_batch(differing), "C": scalar}, count)
    for name, what, target in (("seeds", "their seeds differ", "≤ 0.07"), ("all", "everything differs", "≤ 0.25")):
        yield Figure.of(f"{runs} runs, {what}: one of them ÷ C", ratios(seconds, name, "C", SHARE / runs), target)
