"""Reference models with the library's channels, and runs, for the tests of the Kalman-type observers."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.reference import kalman, motor, tanks
from tests.simulate import simulate
from thetascope import library
from thetascope.engine.model.result import Result
from thetascope_schemas import Experiment

# the library's channel → the reference's, and the sign between them
MOTOR = {
    "gain_loss": ("gain", -1),
    "load_torque": ("torque", 1),
    "friction_increase": ("friction", 1),
    "current_bias": ("current", 1),
    "speed_bias": ("speed", 1),
}
PUMPS = {"pump1": ("pump1", -1), "pump2": ("pump2", -1)}


def reference(plant: str, channels: Sequence[str]) -> kalman.Model:
    """Return the reference model of a library plant, with the library's channels and signs."""
    build, names = {
        "dc-motor": (motor.dc_motor, MOTOR),
        "dts200": (tanks.dts200, PUMPS),
        "quadruple-tank": (tanks.quadruple, PUMPS),
    }[plant]
    pairs = [names.get(c, (c, 1)) for c in channels]
    signs = np.array([sign for _, sign in pairs], float)
    model = build([name for name, _ in pairs])
    return replace(
        model,
        Phi=lambda t, x, u, s: model.Phi(t, x, u, s) * signs,
        Psi=lambda t, x, u, s: model.Psi(t, x, u, s) * signs,
        A=lambda t, x, u, s, theta: model.A(t, x, u, s, theta * signs),
        C=lambda t, x, u, s, theta: model.C(t, x, u, s, theta * signs),
    )


def run(
    plant: str | dict,
    kind: str,
    channels: Sequence[str],
    gains: dict,
    initial: dict | None = None,
    options: dict | None = None,
    **spec,
) -> Result:
    """Run one observer, labelled ``o``, on a library plant, through assembly."""
    observer = {
        "label": "o",
        "kind": kind,
        "gains": gains,
        "initial": initial or {},
        "options": {"channels": ",".join(channels), **_as_printed(kind), **(options or {})},
    }
    return simulate(library.resolve(Experiment.model_validate({"plant": plant, "observers": [observer], **spec})))


def _as_printed(kind: str) -> dict:
    """The options that write the equations of the papers, which the references integrate."""
    return {"forgetting": "plain"} if kind.startswith("adaptive-kalman") else {}


def columns(result: Result, prefix: str, names: Sequence[str]) -> np.ndarray:
    """Return the columns ``prefix.name`` side by side, shape (rows, names)."""
    return np.stack([result.column(f"{prefix}.{name}") for name in names], axis=1)


def outputs(result: Result) -> np.ndarray:
    """Return the measured outputs, shape (rows, m)."""
    return np.stack([result.column(n) for n in result.names if n.startswith("y.")], axis=1)


def close(mine: np.ndarray, theirs: np.ndarray, tolerance: float) -> None:
    """Fail unless every column agrees within ``tolerance`` of its own largest value."""
    scale = np.maximum(np.abs(theirs).max(axis=0), 1e-12)
    error = np.abs(mine - theirs).max(axis=0) / scale
    assert (error < tolerance).all(), f"relative errors {error}"
