"""Small studies, and their tables."""

from pathlib import Path
from typing import Any

import polars as pl

from thetascope.studies.conduct import conduct
from thetascope.studies.engines import LocalEngine
from thetascope.studies.kept import Kept
from thetascope.studies.plan import complete
from thetascope_schemas.service.study.study import Study

GAINS: dict[str, Any] = {
    "experiment": "zhao-2012",
    "set": {"horizon": 4.0, "evaluate": 0.1, "faults.0.onset": 1.0, "faults.1.onset": 2.0},
    "vary": [
        {"kind": "list", "path": "observers.adaptive.gains.rho", "values": [2, 4, 8], "name": "rho"},
        {"kind": "range", "path": "noise.y.std", "low": 0.0005, "high": 0.001, "points": 2, "name": "noise"},
    ],
    "seeds": 9,
    "faults": "both",
    "measures": ["rmse", "peak", "settling", "operations"],
    "numbers": {"end": {"kind": "level", "take": "mean", "column": "adaptive.theta.theta3", "start": 3.0}},
}
"""108 runs in two blocks, all of one shape."""


def study(data: dict[str, Any], **changes: Any) -> Study:
    """Return a complete study."""
    return complete(Study.model_validate(data | changes))


def computed(one: Study, place: Path, workers: int = 2, threads: bool = True) -> pl.DataFrame:
    """Return the table of a study that is computed in a folder."""
    kept = Kept(one, place)
    engine = LocalEngine(workers, threads)
    try:
        conduct(kept, engine)
    finally:
        engine.close()
    return kept.table()
