"""Structural observability of states and faults, on plants with known results."""

from decimal import Decimal

import pytest

from tests.engine.plants import oscillator
from thetascope import library
from thetascope.assembly import check_plant
from thetascope.engine.observability import identifiability
from thetascope.engine.observability.identifiability import Group, generic, structure
from thetascope.engine.observability.observability_matrix import Lie, Point
from thetascope.engine.observability.taylor import precise
from thetascope.engine.programs.program_store import plant_program
from thetascope_schemas import Plant


def data(name: str) -> dict:
    return library.plant(name).model_dump(mode="json")


def channel(name: str, **enters: str) -> dict:
    return {"name": name, "kind": "process", "enters": enters}


@pytest.mark.parametrize(
    "name",
    [
        "zhao-contois",
        "contois-physical",
        "shen-hu-2015",
        "reduced-order-mimo",
        "dc-motor",
        "quadruple-tank",
        "friction-motor",
    ],
)
def test_the_papers_plants_are_identifiable(name: str):
    """With free inputs and known signals all their states and faults are identifiable."""
    found = structure(data(name))
    assert found.decided
    assert (found.rank, found.state_rank, found.groups) == (found.size, found.states, ())


def test_a_leak_and_a_clogged_outlet_are_confounded():
    """In tank 2 of three tanks they act alike, so no input distinguishes them."""
    found = structure(data("dts200"))
    assert [(g.channels, g.states, g.hidden) for g in found.groups] == [(("leak2", "clog20"), (), 1)]
    assert found.rank == found.size - 1
    assert "leak2 and clog20 cannot be distinguished by any input" in str(found.text)


def test_constant_known_signals_confound_two_faults():
    """Zhao's plant with constant φ1 = φ2: θ1 and θ2 enter as one, rank 4 of 5; with free φ it is 5."""
    plant = data("zhao-contois")
    program = plant_program(plant).program
    with precise():
        lie = Lie(program, ("theta1", "theta2", "theta3"))
        point = generic(plant, program, 1, 0.5, lie.orders)
        one = [Decimal(1)] + [Decimal(0)] * lie.orders
        still = Point(point.values, dict(point.inputs) | {"signal.phi1": one, "signal.phi2": one})
        free, bound = lie.at(point), lie.at(still)
    assert (free.rank, bound.rank) == (5, 4)
    (null,) = bound.null
    assert null[:2] == [0, 0]
    assert abs(null[2] + null[3]) < Decimal("1e-50")
    assert null[4] == 0


@pytest.mark.parametrize(("x12", "before", "rank"), [("0.2", "0.1", 4), ("0", "0", 2)])
def test_the_sandwich_is_observable_where_an_operator_moves(x12: str, before: str, rank: int):
    """Zhou & Tan: of x11, x12, x21, x22 rank 4 while operators are driven, 2 while all hold (READING §4)."""
    plant = data("zhou-tan-2012")
    program = plant_program(plant).program
    driven = Decimal(0 if x12 == "0" else 50)  # x11 keeps x12 rising
    values = {s: Decimal(0) for s in program.states} | {
        "x.x11": driven,
        "x.x12": Decimal(x12),
        "x.x12m": Decimal(before),
    }
    values |= {"p.b": Decimal("0.4107"), "theta.theta1": Decimal(0), "theta.theta2": Decimal(0), "t": Decimal(0)}
    with precise():
        lie = Lie(program, (), unknown=("x.x11", "x.x12", "x.x21", "x.x22"))
        still = Point(values, {"u.u": [driven] * lie.orders})
        assert lie.at(still).rank == rank


def test_faults_that_no_output_shows_are_named():
    """A fault on a state that nothing depends on is invisible; a sensor's offset is equivalent to a shift of a free
    state."""
    plant = oscillator(
        states=[{"name": "x1", "initial": 1.0}, {"name": "x2", "initial": 1.0}, {"name": "x3", "initial": 1.0}],
        dynamics={"x1": "x2", "x2": "-x2 + u", "x3": "-x3"},
        channels=[
            channel("lost", x3="1"),
            {"name": "bias", "kind": "sensor", "enters": {"y": "1"}},
            channel("force", x2="2"),
        ],
    )
    found = structure(plant)
    groups = {(g.channels, g.states) for g in found.groups}
    assert groups == {(("lost",), ()), (("bias",), ("x1",)), ((), ("x3",))}
    assert sorted(found.unidentifiable) == ["bias", "lost"]
    assert "lost shows in no output" in str(found.text)
    assert "bias cannot be distinguished from the state x1" in str(found.text)
    assert found.hidden == 2


def test_channels_can_be_selected():
    """Of two confounded faults one alone is identifiable if the other is absent."""
    assert structure(data("dts200"), ("leak2", "pump1")).groups == ()


def test_a_plant_of_a_hundred_unknowns_is_not_decided():
    """If the work would be too much the report says so instead of guessing."""
    n = 60
    names = [f"x{i}" for i in range(n)]
    plant = oscillator(
        states=[{"name": s, "initial": 1.0} for s in names],
        outputs=[{"name": "y", "expression": "x0"}],
        dynamics={s: f"-{s} + sin({names[(i + 1) % n]})*{s}*{names[(i + 7) % n]}" for i, s in enumerate(names)},
        channels=[channel(f"c{j}", **{names[j]: names[j]}) for j in range(40)],
    )
    found = structure(plant)
    assert not found.decided
    assert str(found.text) == "not decided: the plant is too large"


def test_the_check_of_a_plant_reports_confounded_faults():
    """The faults that no input can distinguish are in the report, as data and in words."""
    plant = oscillator(channels=[channel("force", x2="1"), channel("slip", x2="2*k")])
    seen = check_plant(Plant.model_validate(plant))["observability"]
    assert seen["not_identifiable"] == ["force", "slip"]
    assert (seen["rank"], seen["size"], seen["state_rank"], seen["states"]) == (3, 4, 2, 2)
    assert seen["text"] == seen["groups"][0]["text"] == "force and slip cannot be distinguished by any input"
    chinese = check_plant(Plant.model_validate(plant), "zh")["observability"]
    assert chinese["text"] == chinese["groups"][0]["text"] == "任何输入都无法区分 force和slip"


def test_the_verdict_is_the_same_from_the_cache(tmp_path, monkeypatch):
    """A stored verdict has the sentences of the computed one, with codes and arguments."""
    monkeypatch.setenv("THETASCOPE_CACHE", str(tmp_path))
    computed = structure(data("dts200"))
    monkeypatch.setattr(identifiability, "_structure", None)
    assert structure(data("dts200")) == computed


@pytest.mark.parametrize(
    ("group", "english", "chinese"),
    [
        (Group(("a",), (), 1), "a shows in no output", "a 在任何输出中都不显现"),
        (Group(("a", "b"), (), 2), "a and b show in no output", "a和b 在任何输出中都不显现"),
        (Group((), ("x1",), 0), "the state x1 cannot be determined from the outputs", "状态 x1 无法由输出确定"),
        (
            Group(("a", "b"), ("x1", "x2"), 1),
            "a and b cannot be distinguished by any input, nor from the states x1 and x2",
            "任何输入都无法区分 a和b，也无法将其与状态 x1和x2 区分",
        ),
        (
            Group(("a",), tuple("uvwxyz"), 0),
            "a cannot be distinguished from 6 of the states",
            "a 无法与其中 6 个状态区分",
        ),
    ],
)
def test_a_group_is_worded_in_every_language(group, english, chinese):
    """Hidden, confounded and unobservable faults and states have their sentences."""
    assert (group.text.text("en"), group.text.text("zh")) == (english, chinese)
