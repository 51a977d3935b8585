"""The parts that a batch computes once, found by reachability: nothing is computed twice or left out."""

from dataclasses import replace

import numpy as np
import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.compiler.graph import evaluate, topological
from thetascope.engine.compiler.partition import Partition, partition
from thetascope.engine.compiler.system import Program
from thetascope.engine.simulation.batch import _Lanes, with_seed
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.simulation import joined


@pytest.fixture(scope="module")
def zhao() -> Experiment:
    return prepare(library.resolve(library.experiment("zhao-2012"))).engine


@pytest.fixture(scope="module")
def program(zhao: Experiment) -> Program:
    return joined(zhao.plant, zhao.estimators[0].program)


def families(states: tuple[str, ...]) -> set[str]:
    return {s.split(".")[0] for s in states}


def test_noise_affects_only_the_estimates(zhao: Experiment):
    """zhao-2012 with different seeds: Υ, Γ and the plant are integrated once, x̂ and θ̂ in lanes."""
    parts = _Lanes([with_seed(zhao, i) for i in range(3)], 0).parts
    assert families(parts.shared.states) == {"x", "Upsilon", "Gamma"}
    assert parts.lanes.states == ("xh.x1", "xh.x2", "thetah.theta1", "thetah.theta2", "thetah.theta3")


def test_an_initial_estimate_affects_only_the_estimates(zhao: Experiment):
    """So does x̂(0); another Γ(0) affects Γ, but neither the plant nor Υ."""

    def other(name: str) -> Experiment:
        estimator = zhao.estimators[0]
        return replace(zhao, estimators=(replace(estimator, parameters=estimator.parameters | {name: 0.5}),))

    lanes = {name: families(_Lanes([zhao, other(name)], 0).parts.lanes.states) for name in ("x0.x1", "g.gamma0.0")}
    assert lanes == {"x0.x1": {"xh", "thetah"}, "g.gamma0.0": {"Gamma", "xh", "thetah"}}


def test_a_fault_affects_the_plant_and_the_estimates_but_not_the_gains(program: Program):
    """Υ and Γ depend on known signals only."""
    parts = partition(program, frozenset({"theta.theta1"}), frozenset())
    assert families(parts.shared.states) == {"Upsilon", "Gamma"}
    assert families(parts.lanes.states) == {"x", "xh", "thetah"}


def test_if_everything_differs_nothing_is_shared(program: Program):
    """The lanes are then the whole program and no value is passed on."""
    differing = frozenset({"noise.y.y", "g.rho", "p.a4", *program.states})
    parts = partition(program, differing, frozenset())
    assert parts.shared is None and parts.handed == ()
    assert parts.lanes.states == program.states


def rates(parts: Partition, values: dict) -> dict[str, float]:
    """Return the derivatives as the two parts compute them, with the shared values passed from one to the other."""
    found = {}
    shared, lanes = parts.shared, parts.lanes
    handed = evaluate(shared.graph, list(parts.handed), values)
    found |= zip(shared.states, evaluate(shared.graph, list(shared.update), values), strict=True)
    found |= zip(
        lanes.states,
        evaluate(lanes.graph, list(lanes.update), values | dict(zip(parts.names, handed, strict=True))),
        strict=True,
    )
    return found


@pytest.mark.parametrize("differing", [{"noise.y.y"}, {"theta.theta1"}, {"g.rho"}, {"xh.x1"}, {"p.a4"}], ids=str)
@pytest.mark.parametrize("staged", [set(), {"u.u", "signal.phi1"}], ids=["held", "staged"])
def test_the_parts_together_equal_the_program(program: Program, differing: set[str], staged: set[str]):
    """At random values every derivative has the bits of the undivided program."""
    rng = np.random.default_rng(4)
    names = {n[1] for n in program.graph.index if n[0] == "var"}
    values = {n: float(v) for n, v in zip(sorted(names), rng.uniform(0.1, 1.0, len(names)), strict=True)}
    found = rates(partition(program, frozenset(differing), frozenset(staged)), values)
    whole = evaluate(program.graph, list(program.update), values)
    assert found == dict(zip(program.states, whole, strict=True))


def test_products_of_shared_factors_are_formed_once(zhao: Experiment, program: Program):
    """In the lanes of zhao-2012 no operation has shared arguments only, except those that are constant in a run."""
    parts = _Lanes([with_seed(zhao, i) for i in range(3)], 0).parts
    graph, differs = parts.lanes.graph, set(parts.lanes.states) | {"noise.y.y"}
    reached: set[int] = set()
    moving = set(parts.names)
    for i in topological(graph, parts.lanes.update):
        op, *args = graph.nodes[i]
        if op == "var":
            reached |= {i} if args[0] in differs else set()
        elif op != "const":
            reached |= {i} if reached & set(args) else set()
            handed_over = any(graph.nodes[a] == ("var", n) for a in args for n in moving)
            assert i in reached or not handed_over
    operations = [graph.nodes[i][0] for i in topological(graph, parts.lanes.update)]
    assert sum(op in ("mul", "fma", "div") for op in operations) < 30


def test_held_values_are_recomputed_and_staged_ones_passed_on(program: Program):
    """A held product costs the lanes nothing, since it is formed once per segment; a staged one would be formed at
    every stage."""
    both = [len(partition(program, frozenset({"noise.y.y"}), frozenset(s)).handed) for s in ({}, {"u.u"})]
    assert both[0] < both[1]
