"""The points of a study: a pure function of the spec, whatever the order in which they are asked for."""

import itertools

import numpy as np
import pytest
from scipy.stats import qmc

from thetascope.runs.specs.refusals import InvalidSpec, validated
from thetascope.studies.design import values_at
from thetascope_schemas.service.study.study import Study

RATE = {"kind": "range", "path": "observers.adaptive.gains.lambda", "low": 0.5, "high": 16.0, "scale": "log"}
NOISE = {"kind": "range", "path": "noise.y.std", "low": 0.0, "high": 0.002}
LIST = {"kind": "list", "path": "noise.y.sample_time", "name": "hold", "values": [3, 1, 2]}


def study(**changes) -> Study:
    return Study.model_validate({"experiment": "zhao-2012"} | changes)


def shown(one: Study) -> list[tuple]:
    return [tuple(value.shown for value in values_at(one, point)) for point in range(one.point_count)]


def test_a_grid_has_every_combination_once():
    """The last factor changes fastest, and bounds are hit exactly."""
    one = study(vary=[RATE | {"points": 4}, LIST])
    rates = [0.5, 0.5 * 32 ** (1 / 3), 0.5 * 32 ** (2 / 3), 16.0]
    expected = list(itertools.product(rates, [3.0, 1.0, 2.0]))
    assert shown(one)[0] == (0.5, 3.0) and shown(one)[-1] == (16.0, 2.0)
    np.testing.assert_allclose(shown(one), expected, rtol=1e-14)


@pytest.mark.parametrize("design", ["random", "latin-hypercube", "sobol"])
def test_a_sampled_point_depends_on_its_number_only(design: str):
    """Asked for backwards and alone, points are the same; another seed gives others."""
    one = study(vary=[RATE, NOISE, LIST], design=design, points=40)
    forwards = shown(one)
    backwards = [tuple(value.shown for value in values_at(one, point)) for point in reversed(range(40))]
    assert forwards == backwards[::-1]
    assert shown(study(vary=[RATE, NOISE, LIST], design=design, points=40, design_seed=1)) != forwards
    rates, noises, seeds = map(np.array, zip(*forwards, strict=True))
    assert ((rates >= 0.5) & (rates <= 16)).all() and ((noises >= 0) & (noises <= 0.002)).all()
    assert set(seeds) == {1.0, 2.0, 3.0}


def test_a_latin_hypercube_has_one_point_in_every_row_and_column():
    """Each of n equal parts of each range holds one of n points."""
    one = study(vary=[NOISE, NOISE | {"name": "other"}], design="latin-hypercube", points=25)
    for column in zip(*shown(one), strict=True):
        assert sorted((np.array(column) / 0.002 * 25).astype(int)) == list(range(25))


def test_sobol_points_are_those_of_scipy_across_chunks():
    """Points beyond the first 1024 continue the same sequence, and cover the square more evenly than random ones."""
    factors = [NOISE | {"high": 1.0, "name": name} for name in ("a", "b")]
    one = study(vary=factors, design="sobol", points=2048)
    expected = qmc.Sobol(2, rng=np.random.default_rng(0)).random(2048)
    np.testing.assert_array_equal(np.array(shown(one)), expected)
    random = np.array(shown(study(vary=factors, design="random", points=2048)))
    assert qmc.discrepancy(expected) < 0.1 * qmc.discrepancy(random)


def test_faults_and_their_pairs():
    """Every fault alone, then every two together."""
    sizes = {"theta1": 0.01, "theta2": 0.02, "theta3": 0.03}
    one = study(vary=[{"kind": "faults", "name": "fault", "sizes": sizes, "onset": 20.0, "pairs": True}])
    assert [s for (s,) in shown(one)] == [
        *("theta1", "theta2", "theta3"),
        *("theta1 + theta2", "theta1 + theta3", "theta2 + theta3"),
    ]
    (value,) = values_at(one, 5)
    assert value.faults is not None and [f["size"] for f in value.faults] == [0.02, 0.03]


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"vary": [RATE]}, "vary[0].points"),
        ({"vary": [RATE | {"low": 0.0, "points": 3}]}, "vary[0].low"),
        ({"vary": [RATE | {"high": 0.1, "points": 3}]}, "vary[0].high"),
        ({"vary": [RATE], "design": "sobol"}, "points"),
        ({"vary": [RATE | {"points": 3}], "points": 3}, "points"),
        ({"vary": [RATE], "design": "latin-hypercube", "points": 200_000}, "points"),
        ({"vary": [LIST, LIST]}, "vary[1].name"),
        ({"vary": [LIST | {"name": "rmse.mine"}]}, "vary[0].name"),
        ({"vary": [LIST | {"name": "run"}]}, "vary[0].name"),
        ({"vary": [{**RATE, "name": str(i), "points": 1000} for i in range(4)]}, "vary"),
        ({"vary": [{**LIST, "values": []}]}, "vary[0].values"),
        ({"seeds": 0}, "seeds"),
    ],
)
def test_what_has_no_table_is_refused(changes: dict, field: str):
    """1e12 runs among them; the error names the field and a remedy."""
    with pytest.raises(InvalidSpec) as refused:
        validated(Study, {"experiment": "zhao-2012"} | changes)
    assert refused.value.errors[0].field == field
    assert refused.value.errors[0].remedy
