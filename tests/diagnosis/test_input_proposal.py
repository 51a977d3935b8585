"""Inputs that restore excitation, on plants of the library."""

import numpy as np
import pytest
from pydantic import TypeAdapter

from thetascope import library
from thetascope.assembly import prepare
from thetascope.diagnosis.input_design.excitation import excitation
from thetascope.diagnosis.input_design.input_proposal import Proposal, propose
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import Simulation, row_values
from thetascope_schemas import Experiment, InputProposal, Signal

PAIR = ("load_torque", "friction_increase")


def healthy(name: str, **changes) -> Engine:
    """Return an experiment of the library without observers and faults, as an engine object."""
    spec = library.experiment(name).model_dump(mode="json") | {"observers": [], "figures": [], "faults": []} | changes
    return prepare(library.resolve(Experiment.model_validate(spec))).engine


def constant(value: float) -> dict:
    return {"kind": "constant", "value": value}


def proposed(e: Engine, window: float, among=None, k: int = 0) -> Proposal:
    x = e.x0 if k == 0 else list(Simulation(e).spans(k))[-1][0].plant
    return propose(InnovationFilter(e, e.context), e, x, k, window, 0.1, among)


def information(e: Engine, window: float) -> np.ndarray:
    """Return J over the last window of a run, as the detector accumulates it."""
    made = InnovationFilter(e, e.context)
    rows = [r for _, r in Simulation(e).spans(e.steps + 1)]
    index, plant = np.concatenate([r.index for r in rows]), np.concatenate([r.plant for r in rows])
    table = made.table(index, np.concatenate([r.y for r in rows]), row_values(e, index, plant), e.signals)
    omega = made.run(made.start(), np.zeros(made.p), table, index * e.step).omega[-round(window / made.interval) :]
    return np.einsum("kmi,kmj->ij", omega, omega)


def excited(e: Engine, window: float, among=None):
    """Return the excitation of the last window of a run."""
    channels = e.context.model["channels"]
    picked = [i for i, c in enumerate(channels) if among is None or c["name"] in among]
    J = information(e, window)[np.ix_(picked, picked)]
    return excitation(J, [channels[i]["name"] for i in picked], [channels[i]["typical"] for i in picked], 0.1)


def test_a_moving_voltage_is_proposed_for_a_motor_at_constant_speed():
    """Load and friction have the same effect at constant speed; the proposed voltage distinguishes them."""
    still = healthy("dc-motor", inputs={"voltage": constant(12)})
    before = excited(still, 2.0, PAIR)
    assert str(before.text).startswith(
        "load_torque and friction_increase cannot be distinguished with this input: only their"
    )
    assert not any(before.identifiable.values())
    found = proposed(still, 2.0, PAIR, k=10_000)
    assert found.input == "voltage"
    assert found.before < 1
    assert found.level > 50
    assert TypeAdapter(Signal).validate_python(found.signal).model_dump(mode="json", exclude_none=True) == found.signal
    InputProposal.model_validate(vars(found))
    moving = healthy("dc-motor", inputs={"voltage": found.signal})
    after = excited(moving, 2.0, PAIR)
    assert after.level == pytest.approx(found.level, rel=0.3)


def test_the_proposal_is_within_the_bounds_of_the_input():
    """No proposal leaves the declared range of the voltage."""
    found = proposed(healthy("dc-motor", inputs={"voltage": constant(22)}), 2.0, PAIR)
    assert -24 <= found.signal["low"] < found.signal["high"] <= 24


def test_no_input_helps_if_known_signals_are_equal():
    """With φ1 = φ2 = 1 only θ1 + θ2 is visible, whatever u is; with the paper's φ each θ is identifiable."""
    alike = healthy("zhao-2012", signals={"phi1": constant(1), "phi2": constant(1)})
    seen = excited(alike, 10.0)
    assert (
        "theta1 and theta2 cannot be distinguished with this input: only their combination theta1 + theta2 is visible"
        in str(seen.text)
    )
    assert seen.identifiable == {"theta1": False, "theta2": False, "theta3": True}
    found = proposed(alike, 2.0)
    assert found.input is None
    assert found.signal is None
    assert "phi1, phi2" in str(found.text)
    assert "theta1 and theta2 cannot be distinguished" in str(found.text)
    InputProposal.model_validate(vars(found))
    paper = excited(healthy("zhao-2012"), 10.0)
    assert str(paper.text).startswith("all faults can be distinguished")
    assert all(paper.identifiable.values())


def test_the_smallest_sufficient_input_is_proposed():
    """Friction is not visible at rest: the smallest sufficient amplitude is proposed."""
    e = healthy("friction-motor", inputs={"torque": constant(0)})
    found = proposed(e, 2.0)
    assert found.before == 0
    assert found.level > found.needed
    assert found.input == "torque"
    values = found.signal.get("values", [found.signal.get(n, 0) for n in ("low", "high", "amplitude")])
    assert max(map(abs, values)) <= 0.2  # a twentieth of −2 … 2, and not a quarter
    assert "would make the fault visible" in str(found.text)


def test_structurally_confounded_faults_do_not_prevent_a_proposal():
    """Three tanks at rest: an input is proposed for the other faults, although leak2 and clog20 stay confounded."""
    names = ("pump1", "pump2", "leak2", "clog20")
    e = healthy("dts200", inputs={"Q1": constant(30), "Q2": constant(30)})
    found = proposed(e, 200.0, names)
    assert found.level > 1
    assert "leak2 and clog20 cannot be distinguished" in str(found.text)


def test_a_moving_voltage_is_proposed_for_tanks_at_rest():
    """Quadruple tank with constant voltages: pumps, leak and sensor offset are confounded; a moving voltage helps."""
    names = ("pump1", "pump2", "leak1", "level2")
    found = proposed(healthy("quadruple-tank", inputs={"v1": constant(3), "v2": constant(3)}), 400.0, names)
    assert found.input in ("v1", "v2")
    assert found.before < 1e-3
    assert found.level > 1
