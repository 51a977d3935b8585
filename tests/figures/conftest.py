"""A run for the tests of figures: three faults in a bioreactor, two observers with estimates in closed form."""

import numpy as np
import pytest

from thetascope.engine.model.result import Check, Diverged, ObserverReport, Result
from thetascope.messages import Message
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant

FAULTS = {"theta1": (40.0, 0.01), "theta2": (70.0, 0.015), "theta3": (20.0, 0.02)}
PULSE = {"kind": "pulse", "low": 0, "high": 1, "period": 0.5, "width": 0.25}
RATES = {"adaptive": 1.2, "slow": 0.3}


@pytest.fixture(scope="session")
def plant() -> Plant:
    return Plant.model_validate(
        {
            "id": "bioreactor",
            "title": "Bioreactor",
            "description": "Growth, with three faults.",
            "source": "a paper",
            "states": [
                {"name": "x1", "unit": "1/h", "initial": 0.09, "description": "specific growth rate"},
                {"name": "x2", "unit": "1/h2", "initial": 0.01},
            ],
            "inputs": [{"name": "u", "unit": "1/h", "default": 0.08}],
            "outputs": [{"name": "y", "unit": "1/h", "expression": "x1"}],
            "parameters": [{"name": "a1", "value": 1}],
            "signals": [{"name": "phi1", "default": PULSE}],
            "definitions": [{"name": "w", "expression": "x2/x1", "domain": [0, "a1"]}],
            "dynamics": {"x1": "x2 - u*x1", "x2": "x1*w*(2*w - 1 - u) + 0.1*u*(1 - w)**2"},
            "channels": [
                {"name": "theta1", "title": "Feed leak", "kind": "actuator", "enters": {"x1": "phi1"}, "unit": "1/h2"},
                {"name": "theta2", "title": "Wash-out", "kind": "process", "enters": {"x2": "-phi1"}},
                {"name": "theta3", "title": "Sensor bias", "kind": "sensor", "enters": {"y": 1}, "unit": "1/h"},
            ],
        }
    )


@pytest.fixture(scope="session")
def experiment(plant):
    """Return a function that builds the experiment; keyword arguments replace its fields."""

    def build(**changes) -> Experiment:
        fields = {
            "id": "three-faults",
            "title": "Three faults",
            "source": "a paper",
            "plant": plant,
            "errata": ["A sign is wrong."],
            "faults": [
                {"channel": name, "shape": "step", "onset": at, "size": size} for name, (at, size) in FAULTS.items()
            ],
            "noise": {"y": {"std": 0.001}},
            "seed": 7,
            "horizon": 100.0,
            "step": 0.001,
            "observers": [
                {"label": label, "kind": "zhao-adaptive", "gains": {"rho": 4, "lambda": 4.0}} for label in RATES
            ],
        }
        return Experiment.model_validate(fields | changes)

    return build


def _columns(rows: int, labels: list[str], lost: dict[str, float]) -> dict[str, np.ndarray]:
    t = np.linspace(0, 100, rows)
    columns = {
        "t": t,
        "u.u": np.where((t >= 10) & (t < 20), 0.02, 0.08),
        "signal.phi1": (t % 0.5 < 0.25) * 1.0,
        "x.x1": 0.1 + 0.02 * np.sin(t / 9),
        "x.x2": 0.01 + 0.002 * np.cos(t / 5),
    }
    columns |= {f"theta.{name}": np.where(t >= at, size, 0.0) for name, (at, size) in FAULTS.items()}
    columns["y.y"] = columns["x.x1"] + columns["theta.theta3"]
    for place, label in enumerate(labels):
        rate, alive = RATES.get(label, 0.5 + place), np.where(t > lost.get(label, np.inf), np.nan, 1.0)
        for name in ("x1", "x2"):
            columns[f"{label}.x.{name}"] = alive * (columns[f"x.{name}"] + 0.05 * np.exp(-rate * t))
        for name, (at, size) in FAULTS.items():
            columns[f"{label}.theta.{name}"] = alive * np.where(t >= at, size * (1 - np.exp(-rate * (t - at))), 0.0)
        columns[f"{label}.y.y"] = columns[f"{label}.x.x1"] + columns[f"{label}.theta.theta3"]
        columns[f"{label}.pe"] = 0.0026 + 0.0005 * np.sin(t)
    return columns


@pytest.fixture(scope="session")
def result():
    """Return a function that builds the result: errors decay as exp(−rate·t); `lost` has times of divergence."""

    def build(spec: Experiment, rows: int = 10_001, lost: dict[str, float] | None = None) -> Result:
        lost = lost or {}
        columns = _columns(rows, [o.label for o in spec.observers], lost)
        checks = (
            Check(
                Message("check.excitation"),
                "holds",
                Message("check.definite.smallest", value=0.0026),
                0.0026,
                0.002,
                "eq. (36)",
            ),
            Check(
                Message("check.f-lipschitz"), "cannot tell", Message("check.chain.broken"), None, None, "assumption 2"
            ),
        )
        reports = tuple(
            ObserverReport(
                o.label,
                o.kind,
                Message("observer.adaptive-kalman.title"),
                checks,
                Diverged(lost[o.label], Message("diverged.upsilon")) if o.label in lost else None,
                {"k0": [2.0, 1.0]},
            )
            for o in spec.observers
        )
        return Result(
            tuple(columns), np.ascontiguousarray(list(columns.values())), reports, None, 0.001, 1, (), {"run": 0.03}
        )

    return build
