"""Summaries: medians, rates with intervals, ROC, confusion, sensitivity, Pareto, against loops and known answers."""

import numpy as np
import polars as pl
import pytest

from thetascope.studies.plan import complete
from thetascope.studies.summary import (
    against,
    by_size,
    confusion,
    pareto,
    roc,
    sensitivity,
    sizes_varied,
    smallest_found,
)
from thetascope.studies.tables import latex, point_table
from thetascope_schemas.service.study.study import Study

RATES = {"kind": "list", "path": "diagnosis.false_alarms", "values": [0.01, 0.1], "name": "rate"}


def detections(n: int = 400, seed: int = 3) -> pl.DataFrame:
    """Return a made-up table: alarms with known probabilities, by the rate and by whether faults act."""
    rng = np.random.default_rng(seed)
    rate = np.repeat([0.01, 0.1], n)
    faulty = np.tile([True, False], n)
    chance = np.where(faulty, np.where(rate > 0.05, 0.9, 0.6), rate)
    alarm = rng.random(2 * n) < chance
    return pl.DataFrame(
        {
            "run": np.arange(2 * n),
            "point": (rate > 0.05).astype(int),
            "faulty": faulty,
            "rate": rate,
            "alarms.detector": alarm.astype(float),
            "name.detector": [("a" if f else "b") if x else None for x, f in zip(alarm, faulty, strict=True)],
            "found.detector.a": [float(x) if f else None for x, f in zip(alarm, faulty, strict=True)],
            "delay.detector.a": [rng.exponential() if x and f else None for x, f in zip(alarm, faulty, strict=True)],
        }
    )


def study(*vary: dict) -> Study:
    return Study.model_validate({"experiment": "friction-motor", "vary": list(vary), "faults": "both"})


def test_a_roc_agrees_with_a_loop_over_single_runs():
    """Counts of both kinds of runs, and the median delay of the faults found."""
    table = detections()
    points = roc(table, "detector", "rate")
    for point in points:
        false = found = healthy = faulty = 0
        delays = []
        for row in table.iter_rows(named=True):
            if row["rate"] != point.value:
                continue
            if row["faulty"]:
                faulty += 1
                found += row["found.detector.a"] == 1
                delays += [row["delay.detector.a"]] if row["delay.detector.a"] is not None else []
            else:
                healthy += 1
                false += row["alarms.detector"] > 0
        assert (point.false.count, point.false.of, point.found.count, point.found.of) == (false, healthy, found, faulty)
        assert point.delay.median == pytest.approx(np.median(delays)) and point.delay.n == found
        assert point.false.low <= false / healthy <= point.false.high
    assert points[0].found.share < points[1].found.share


def test_names_confused_add_up_to_the_runs():
    """True faults by rows, those of the experiment where none varies; what the first alarm named by columns."""
    table = detections()
    counts = confusion(table, complete(study(RATES)), "detector")
    assert sum(counts["friction"].values()) == 400 and sum(counts["none"].values()) == 400
    assert counts["friction"]["a"] == int(table["found.detector.a"].sum())
    assert set(counts["none"]) == {"none", "b"}


def test_against_gives_medians_of_each_value_and_shares_with_intervals():
    """Of runs without faults nothing is expected to be found."""
    table = detections()
    rows = against(table, "found.detector.a", "rate")
    assert [row.value for row in rows] == [0.01, 0.1] and all(row.rate and row.rate.of == 200 for row in rows)
    delays = against(table, "delay.detector.a", "rate")
    for row in delays:
        mine = table.filter((pl.col("rate") == row.value) & pl.col("delay.detector.a").is_not_null())[
            "delay.detector.a"
        ]
        assert (row.spread.low, row.spread.median, row.spread.high) == tuple(
            np.quantile(mine.to_numpy(), [0.25, 0.5, 0.75])
        )
    assert smallest_found(rows, 0.5) == 0.01 and smallest_found(rows, 0.8) == 0.1 and smallest_found(rows, 0.99) is None


def sized(values, seed=2) -> pl.DataFrame:
    """Return a made-up table: a fault "a" whose chance to be found is its size, the sooner the larger it is."""
    rng = np.random.default_rng(seed)
    size = np.asarray(values, dtype=float)
    found = rng.random(len(size)) < np.abs(size)
    return pl.DataFrame(
        {
            "run": np.arange(len(size)),
            "point": np.arange(len(size)),
            "faulty": [True] * len(size),
            "size": size,
            "alarms.detector": found.astype(float),
            "found.detector.a": found.astype(float),
            "found.detector.b": pl.Series([None] * len(size), dtype=pl.Float64),
            "delay.detector.a": [1 / abs(s) if f else None for s, f in zip(size, found, strict=True)],
        }
    )


def test_what_is_found_by_size_agrees_with_a_loop():
    """Counts and median delays of each size, the smallest found nine times of ten; none of healthy channels."""
    table = sized(np.repeat([-0.2, -0.5, -0.97, -1.0], 60))
    (channel,) = by_size(table, "size", "detector")
    assert channel.channel == "a" and [one.size for one in channel.points] == [-1.0, -0.97, -0.5, -0.2]
    for one in channel.points:
        rows = table.filter(pl.col("size") == one.size)
        assert (one.found.count, one.found.of) == (int(rows["found.detector.a"].sum()), 60)
        assert one.delay.n == one.found.count and one.delay.median == pytest.approx(1 / abs(one.size))
        assert rows["run"][0] == one.run
    assert channel.smallest == -0.97
    assert by_size(table, "size", "detector", 1.0)[0].smallest == -1.0
    assert by_size(sized([0.1] * 50), "size", "detector")[0].smallest is None


def test_numbers_of_a_sampled_design_are_taken_in_classes():
    """500 different sizes give 20 classes of 25 runs at their medians, in order."""
    table = sized(np.random.default_rng(1).permutation(np.linspace(0.01, 1, 500)))
    (channel,) = by_size(table, "size", "detector")
    assert [one.found.of for one in channel.points] == [25] * 20
    sizes = [one.size for one in channel.points]
    assert sizes == sorted(sizes) and sizes[0] == pytest.approx(np.median(np.linspace(0.01, 1, 500)[:25]))
    assert 0.8 < channel.smallest < 1


def test_factors_that_are_sizes_are_known():
    """By their path, whatever they are called; names and other numbers are not sizes."""
    size = {"kind": "range", "path": "faults.friction.size", "low": 0.1, "high": 1.0, "points": 3, "name": "loss"}
    assert sizes_varied(study(size, RATES)) == ("loss",)


def test_first_order_indices_of_the_ishigami_function():
    """S1 = 0.3139, S2 = 0.4424, S3 = 0 for a = 7, b = 0.1 (Ishigami and Homma 1990), from 20 000 random runs."""
    rng = np.random.default_rng(5)
    x = rng.uniform(-np.pi, np.pi, (20_000, 3))
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    table = pl.DataFrame({"faulty": [True] * 20_000, "a": x[:, 0], "b": x[:, 1], "c": x[:, 2], "number.y": y})
    factors = [{"kind": "range", "path": p, "name": p, "low": -3.2, "high": 3.2, "points": 2} for p in "abc"]
    found = {one.factor: one.first for one in sensitivity(table, study(*factors), "number.y")}
    assert found["a"] == pytest.approx(0.3139, abs=0.02)
    assert found["b"] == pytest.approx(0.4424, abs=0.02)
    assert found["c"] == pytest.approx(0.0, abs=0.01)


def test_names_have_an_index_too_and_noise_has_none():
    """A factor of two names explains what it shifts, without the bias of few runs in a class."""
    rng = np.random.default_rng(1)
    kind = rng.integers(0, 2, 4000)
    y = kind + rng.normal(size=4000)
    columns = {"faulty": [True] * 4000, "k": np.where(kind, "p", "q"), "n": rng.random(4000), "number.y": y}
    table = pl.DataFrame(columns)
    factors = [
        {"kind": "cases", "name": "k", "cases": {"p": {}, "q": {}}},
        {"kind": "range", "path": "n", "low": 0.0, "high": 1.0, "points": 2},
    ]
    found = {one.factor: one for one in sensitivity(table, study(*factors), "number.y")}
    assert found["k"].first == pytest.approx(0.25 / 1.25, abs=0.03) and found["k"].rank is None
    assert found["n"].first == pytest.approx(0, abs=0.01) and abs(found["n"].rank) < 0.05


def test_the_pareto_front_holds_the_points_that_no_other_beats():
    """Against every pair of points."""
    rng = np.random.default_rng(2)
    table = pl.DataFrame(
        {
            "run": range(60),
            "faulty": [True] * 60,
            "point": np.repeat(range(20), 3),
            "number.a": rng.random(60),
            "number.b": rng.random(60),
        }
    )
    points = pareto(table, "number.a", "number.b")
    assert len(points) == 20
    for one in points:
        beaten = any(o.a <= one.a and o.b <= one.b and (o.a, o.b) != (one.a, one.b) for o in points)
        assert one.best != beaten


def test_a_latex_table_is_escaped():
    """Names with underscores, percent signs, ranges."""
    text = latex(point_table(detections(), study(RATES), ["found.detector.a", "alarms.detector"]))
    assert text.count(r"\\") == 3 and r"\%" in text and "–" not in text
