"""Measure studies: a run of one against a run in lanes, a second worker against the first, memory against runs.

python -m benchmarks studies
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.measure import Figure, rounds
from thetascope.assembly import prepare
from thetascope.engine.simulation.batch import run_batch, with_seed
from thetascope.studies.block import compute
from thetascope.studies.kept import document_of
from thetascope.studies.plan import complete, experiment_of_point
from thetascope_schemas.service.study.study import Study

LANES = {
    "experiment": "zhao-2012",
    "set": {"substeps": 1, "record": 0.5, "evaluate": 0.5},
    "vary": [{"kind": "range", "path": "observers.adaptive.gains.lambda", "low": 2.0, "high": 6.0, "points": 4}],
    "seeds": 256,
    "measures": ["rmse"],
}
DETECTOR = {
    "experiment": "friction-motor",
    "vary": [{"kind": "list", "path": "diagnosis.false_alarms", "values": [0.01, 0.1]}],
    "seeds": 60,
    "faults": "both",
}
COUNT = 64  # runs of a block in lanes


def figures() -> Iterator[Figure]:
    """Yield the ratios."""
    yield from _lanes()
    if (os.cpu_count() or 1) > 1:
        yield from _scaling("zhao-2012, errors only", LANES | {"seeds": 4096})
        yield from _scaling("friction-motor, with the detector", DETECTOR)
    yield _memory()


def _lanes() -> Iterator[Figure]:
    study = complete(Study.model_validate(LANES))
    document = document_of(study)
    engine = prepare(experiment_of_point(study, 0)).engine
    engines = [with_seed(engine, seed) for seed in range(COUNT)]
    seconds = rounds({"study": lambda: compute(document, 0, COUNT), "lanes": lambda: run_batch(engines)}, 7)
    ratios = [a / b for a, b in zip(seconds["study"], seconds["lanes"], strict=True)]
    yield Figure.of("zhao-2012 (100 s at 1 ms), errors: a run of a study ÷ one in lanes", ratios)


def _scaling(name: str, data: dict) -> Iterator[Figure]:
    """Yield the speed of two processes against twice that of one, without the time in which they start."""
    shares = []
    for _ in range(3):
        one, two = (_rate(data, workers) for workers in (1, 2))
        shares.append(two / (2 * one))
    yield Figure.of(f"{name}: two processes ÷ twice one", shares, "≥ 0.9")


def _rate(data: dict, workers: int) -> float:
    """Return runs per second between the first block and the last."""
    script = """
import json, sys, tempfile, time
from thetascope.studies.conduct import conduct
from thetascope.studies.engines import LocalEngine
from thetascope.studies.kept import Kept
from thetascope.studies.plan import complete
from thetascope_schemas.service.study.study import Study
if __name__ == "__main__":
    kept = Kept(complete(Study.model_validate(json.loads(sys.argv[1]))), tempfile.mkdtemp())
    engine, seen = LocalEngine(int(sys.argv[2])), []
    conduct(kept, engine, lambda now: seen.append((time.monotonic(), now.done)))
    engine.close()
    seen = seen[1 + 2 * int(sys.argv[2]) :]  # while every worker was at work
    assert len(seen) > 8, "a longer study is needed"
    print((seen[-1][1] - seen[0][1]) / (seen[-1][0] - seen[0][0]))
"""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.py"
        path.write_text(script)
        found = subprocess.run(
            [sys.executable, str(path), json.dumps(data), str(workers)], check=True, capture_output=True, text=True
        )
    return float(found.stdout)


def _memory() -> Figure:
    """Return the most memory that the command needs for 8192 runs against that for 1024."""
    peaks = [_peak(seeds) for seeds in (256, 2048)]
    return Figure.of("most memory of `thetascope study`: 8192 runs ÷ 1024 runs", [peaks[1] / peaks[0]], "≤ 1.1")


def _peak(seeds: int) -> float:
    """Return the largest resident memory of one process that computes a study, in the system's unit."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.json"
        short = LANES | {"set": {"substeps": 1, "horizon": 5, "record": 0.5, "evaluate": 0.5}, "seeds": seeds}
        path.write_text(json.dumps(short | {"faults": "without"}))
        script = "import sys; from thetascope.cli.main import main; sys.exit(main(sys.argv[1:]))"
        command = [sys.executable, "-c", script, "study", str(path), "--workers", "1", "--threads", "--quiet"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        _, _, usage = os.wait4(process.pid, 0)
    return float(usage.ru_maxrss)
