"""The cost of observers: measured in the run, separately, and never a part of its numbers."""

import numpy as np
import pytest

from tests.engine.plants import adaptive, engine
from thetascope.engine.execution import run_experiment as running
from thetascope.engine.execution.run_experiment import alone, run
from thetascope.engine.programs.kernel_cost import costs, divided, operations
from thetascope.engine.simulation.simulation import Simulation

EKF = {"label": "ekf", "kind": "joint-ekf", "options": {"channels": "force", "period": 0.05}}


def test_every_observer_has_a_cost_and_it_changes_no_number():
    """Joined to the plant, in the plant's time or at a sample period; two runs agree bit for bit."""
    e = engine(observers=[adaptive(), adaptive("other"), EKF])
    first, second = run(e), run(e)
    assert set(first.costs) == {"adaptive", "other", "ekf"}
    assert all(0 < cost < 1 for cost in first.costs.values())  # seconds of the processor per simulated second
    np.testing.assert_array_equal(first.data, second.data)


def test_the_first_observer_costs_as_much_as_its_twin(monkeypatch):
    """It shares the plant's kernel but is measured in a separate one, like the same observer in second place."""
    monkeypatch.setattr(running, "_MEASURED", 200_000)
    e = engine(observers=[adaptive(), adaptive("twin")], horizon=1000.0, evaluate=1.0)
    assert Simulation(e).joined
    costs = [run(e).costs for _ in range(5)]
    least = {name: min(one[name] for one in costs) for name in ("adaptive", "twin")}  # other programs only add to it
    assert 0.6 < least["adaptive"] / least["twin"] < 1.6


def test_one_observer_alone_is_measured_in_the_run_itself():
    """No second kernel is compiled without a comparison, nor for a very large observer."""
    assert alone(engine()) == {}
    two = engine(observers=[adaptive(), adaptive("twin")])
    assert set(alone(two)) == {"adaptive"}


def test_the_time_of_one_kernel_is_divided_by_operations():
    """The parts add up to the whole, and the larger program has the larger part."""
    e = engine()
    plant, observer = e.plant, e.estimators[0].program
    parts = divided(2.0, {"": plant, "adaptive": observer})
    assert sum(parts.values()) == pytest.approx(2.0)
    assert parts["adaptive"] / parts[""] == pytest.approx(operations(observer) / operations(plant))
    assert operations(observer) > operations(plant) > 5
    assert divided(2.0, {"adaptive": observer}) == {"adaptive": 2.0}


def test_costs_are_per_second_of_the_observer():
    """An observer added later is charged for its own time only; without simulation there is no cost."""
    spans = [{"a": (1.0, 10.0)}, {"a": (3.0, 10.0), "b": (1.0, 10.0), "c": (0.0, 0.0)}]
    assert costs(spans) == {"a": 0.2, "b": 0.1}
