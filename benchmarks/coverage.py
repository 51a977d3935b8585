"""Count how often the detector's 95 % intervals hold the truth: ``python -m benchmarks.coverage [SEEDS] [NAME …]``.

Each plant of benchmarks/coverage_plants.py is run with its fault, once for each seed. For every run that names the
fault, its intervals of size and onset are counted. `thetascope trial` counts the same for one experiment, and runs
without faults besides.
"""

import sys

from benchmarks.coverage_plants import CASES, experiment
from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.seed_trial import Coverage
from thetascope.assembly.build.diagnosis_settings import inspector
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.execution.stages import Stage
from thetascope.engine.simulation.batch import with_seed

FIRST_SEED = 10_000


def count(name: str, seeds: range) -> tuple[Coverage, Coverage, int]:
    """Return the coverage of sizes and of onsets on one plant, and the number of other alarms."""
    prepared = prepare(library.resolve(experiment(name)))
    (fault,), engine, inspect = prepared.spec.faults, prepared.stages[0].experiment, inspector(prepared.spec)
    size, onset, others = Coverage(), Coverage(), 0
    for seed in seeds:
        result = run([Stage(0, with_seed(engine, seed))], inspect=inspect)
        assert result.diagnosis is not None
        alarms = result.diagnosis["detector"]["alarms"]
        own = [a for a in alarms if a["channel"] == "fault" and a["t"] >= fault.onset]
        others += len(alarms) - min(len(own), 1)
        if own:
            size.count((own[-1]["size_from"], own[-1]["size_to"]), fault.size)
            onset.count((own[-1]["onset_from"], own[-1]["onset_to"]), fault.onset)
    return size, onset, others


def main(arguments: list[str]) -> int:
    """Print a line for each plant: the shares held of size and onset, the runs that named the fault, other alarms."""
    seeds = int(arguments[0]) if arguments else 100
    for name in arguments[1:] or CASES:
        size, onset, others = count(name, range(FIRST_SEED, FIRST_SEED + seeds))
        held = [f"{100 * c.held / max(c.reported, 1):.1f} %" for c in (size, onset)]
        print(f"| {name} | {held[0]} | {held[1]} | {size.reported} | {others} |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
