"""Count what a truth that differs from the model does to the detector: ``python -m benchmarks.truth [SEEDS] [NAME …]``.

For each experiment and each kind of difference: false alarms per hour in runs without faults; of the runs with the
experiment's faults: faults found, alarms that name a wrong fault, the median delay, and the 95 % intervals of sizes and
onsets that held the true ones. Observers are left out. A deviation has another direction for each seed.
"""

import sys
from collections.abc import Iterator

import numpy as np

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.seed_trial import Tally, trial
from thetascope_schemas import ResolvedExperiment

LAGS: dict[str, tuple[dict[str, str], float]] = {  # what the actuator's lag adds, and its time constant in s
    "zhao-2012": ({"x1": "-(lag - u)*x1", "x2": "-(lag - u)*x1*w + (a1 - w)^2*a4*(lag - u)/(a1*a2)"}, 1.0),
    "quadruple-tank": ({"h1": "gamma1*k1*(lag - v1)/A1", "h4": "(1 - gamma1)*k1*(lag - v1)/A2"}, 10.0),
    "dc-motor": ({"current": "(lag - voltage)/L"}, 0.01),
}


def truths(spec: ResolvedExperiment, name: str) -> Iterator[tuple[str, dict]]:
    """Yield the differences by name, as data."""
    yield "none", {}
    for share in (0.01, 0.02, 0.05):
        yield f"parameters {100 * share:g} % off", {"deviation": share}
    scales = prepare(spec).engine.context.scales
    for share in (0.001, 0.01):
        noise = {
            s: share * x * scales.rate**0.5 for s, x in zip(spec.plant.names("states"), scales.states, strict=True)
        }
        yield f"process noise {100 * share:g} %", {"process_noise": noise}
    outputs = spec.plant.names("outputs")
    hold = {n: spec.noise[n].sample_time for n in outputs}
    row = max(spec.evaluate_interval, *hold.values())
    for times in (2, 10, 100):
        yield f"noise with memory, {times} values", {"outputs": {n: {"correlation": times * hold[n]} for n in outputs}}
    for share in (0.1, 0.5):
        yield f"{100 * share:g} % of samples lost", {"outputs": {n: {"missing": share, "period": row} for n in outputs}}
    yield "one output sampled 10 times slower", {"outputs": {outputs[-1]: {"period": 10 * row}}}
    yield "samples late by up to 0.9 periods", {"outputs": {n: {"jitter": 0.9 * row, "period": row} for n in outputs}}
    added, constant = LAGS[name]
    (source,) = {"u", "v1", "voltage"} & set(spec.plant.names("inputs"))
    lag = {"states": [{"name": "lag", "initial": next(u.default for u in spec.plant.inputs if u.name == source)}]}
    yield f"actuator's lag of {constant:g} s", lag | {"dynamics": {"lag": f"({source} - lag)/{constant}", **added}}


def counted(spec: ResolvedExperiment, truth: dict, seeds: int) -> tuple[Tally, int]:
    """Return the detector's counts over seeds together, and the number of faults."""
    together, faults = None, 0
    for seed in range(seeds):
        one = ResolvedExperiment.model_validate(spec.model_dump() | {"seed": spec.seed + seed, "truth": truth})
        result = trial(prepare(one), 1)
        (tally,), faults = result.tallies, faults + len(result.faults)
        together = tally if together is None else _sum(together, tally)
    assert together is not None, "there is a seed"
    return together, faults


def _sum(a: Tally, b: Tally) -> Tally:
    for count in ("without", "false", "before", "wrong"):
        setattr(a, count, getattr(a, count) + getattr(b, count))
    for channel, found in b.found.items():
        a.found[channel] = a.found.get(channel, 0) + found
    a.delays += b.delays
    for name in ("onset", "size"):
        mine, other = getattr(a, name), getattr(b, name)
        mine.reported, mine.held = mine.reported + other.reported, mine.held + other.held
    return a


def main(arguments: list[str]) -> int:
    """Print a table for each experiment."""
    seeds = int(arguments[0]) if arguments else 20
    for name in arguments[1:] or LAGS:
        spec = library.resolve(library.experiment(name)).model_copy(update={"observers": (), "figures": ()})
        hours = seeds * spec.horizon / 3600
        print(f"\n{name}: {seeds} seeds, {hours:.2f} h without faults and as long with them\n", flush=True)
        print("| Difference | False alarms per hour | Found | Wrong names | Median delay | Size held | Onset held |")
        print("|---|---|---|---|---|---|---|", flush=True)
        for label, truth in truths(spec, name):
            tally, faults = counted(spec, truth, seeds)
            delay = f"{np.median(tally.delays):.3g} s" if tally.delays else "–"
            held = [f"{c.held} of {c.reported}" for c in (tally.size, tally.onset)]
            numbers = f"{tally.false / hours:.3g} | {sum(tally.found.values())} of {faults} | {tally.wrong} | {delay}"
            print(f"| {label} | {numbers} | {' | '.join(held)} |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
