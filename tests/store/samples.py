"""A result with values that are hard to store, and a record."""

import numpy as np

from thetascope.engine.model.result import Check, Diverged, ObserverReport, Result
from thetascope.messages import Message
from thetascope.store import Record


def made_result(rows: int = 50, seed: int = 0) -> Result:
    """Return columns t, x.x and L.x.x, the last with all kinds of floats."""
    data = np.random.default_rng(seed).standard_normal((3, rows))
    data[0] = np.arange(rows) * 0.1
    data[2, :5] = [np.nan, np.inf, -0.0, 5e-324, 0.1 + 0.2]
    checks = (
        Check(
            Message("check.operator-rank"),
            "holds",
            Message("check.gain.value", gain="ρ", value=2.0, why=Message("check.gain.rho")),
            2.0,
            2.0,
            "eq. (3)",
        ),
        Check(Message("check.excitation"), "cannot tell", Message("check.no-value")),
    )
    report = ObserverReport(
        "L",
        "kind",
        Message("observer.high-gain.title"),
        checks,
        Diverged(2.5, Message("diverged.plant")),
        {"K": np.array([1.0, 2.0]), "n": 2},
    )
    return Result(("t", "x.x", "L.x.x"), data, (report,), None, 0.01, 2, (Message("run.substeps", n=2),), {"run": 0.5})


def made_record(id: str, created: float = 1.0, **changes: object) -> Record:
    """Return a record of a finished run."""
    values = {"spec": '{"seed": 1}', "title": "A run", "status": "done", "engine": "e", "summary": {"rows": 50}}
    return Record(id=id, created=created, **(values | changes))
