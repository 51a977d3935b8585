"""What comes out of a study: measures against what varies, rates with intervals, ROC, names confused, sensitivity.

All functions are pure: a table of runs in, plain rows out. Rates carry exact 95 % intervals (Clopper–Pearson).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from re import fullmatch

import numpy as np
import polars as pl
from scipy.stats import spearmanr

from thetascope.diagnosis.evaluation.rates import clopper_pearson
from thetascope.studies.design import is_number, values_at
from thetascope.studies.kept import is_measure
from thetascope_schemas.service.study.factors import FaultsFactor, ListFactor, RangeFactor
from thetascope_schemas.service.study.study import Study

SHARES = ("found.", "size_held.", "onset_held.")
"""Beginnings of the columns that hold 0 or 1, of which a share is meant."""
_MOST_CLASSES = 64
MOST_VALUES, CLASSES = 40, 20
"""Values of a number above which runs are taken in classes, and how many."""


@dataclass(frozen=True)
class Spread:
    """A measure over some runs: its median and the middle half of them; `n` runs have a value, of `of`."""

    n: int
    of: int
    median: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Rate:
    """A share of runs: `count` of `of`, with its interval."""

    count: int
    of: int
    low: float
    high: float

    @property
    def share(self) -> float | None:
        """Return the share; None without runs."""
        return self.count / self.of if self.of else None


@dataclass(frozen=True)
class Against:
    """A measure at one value of a factor, and of a second one where curves are told apart; `run`: the first there."""

    value: float | str
    curve: float | str | None
    spread: Spread
    rate: Rate | None
    run: int


@dataclass(frozen=True)
class RocPoint:
    """A point of a receiver operating characteristic, at one value of the factor that sets how soon an alarm is raised.

    Args:
        value: the factor's.
        false: runs without faults in which there was an alarm.
        found: runs with faults in which all of them were found.
        delay: of the faults found, in s.
    """

    value: float | str
    false: Rate
    found: Rate
    delay: Spread


def values_of(study: Study, point: int) -> dict[str, float | str]:
    """Return the values of the factors at a point, by column."""
    return {value.column: value.shown for value in values_at(study, point)}


def rate_of(count: int, of: int) -> Rate:
    """Return a rate with its interval."""
    return Rate(count, of, *clopper_pearson(count, of))


def spread_of(values: pl.Series) -> Spread:
    """Return median and middle half of the finite values of a column."""
    known = values.drop_nulls().cast(pl.Float64)
    known = known.filter(known.is_finite())
    if not len(known):
        return Spread(0, len(values), None, None, None)
    low, median, high = (float(q) for q in np.quantile(known.to_numpy(), [0.25, 0.5, 0.75]))
    return Spread(len(known), len(values), median, low, high)


def measures(table: pl.DataFrame, study: Study) -> list[str]:
    """Return the columns of numbers that were measured."""
    return [name for name in table.columns if is_measure(name, study) and table.schema[name].is_numeric()]


def against(table: pl.DataFrame, measure: str, factor: str, curve: str | None = None) -> list[Against]:
    """Return a measure at each value of a factor, over all else that varies, in the order of values.

    A number that takes more values than `MOST_VALUES` is taken in classes of equally many runs; `value` is the median.
    """
    used = runs_of(table, measure)
    for one in (factor, curve):
        used = used if one is None else in_classes(used, one)
    keys = [factor] if curve is None else [curve, factor]
    rows = []
    for key, group in used.group_by(keys, maintain_order=True):
        column = group.get_column(measure)
        rate = None
        if measure.startswith(SHARES):
            known = column.drop_nulls()
            rate = rate_of(int(known.sum()), len(known))
        value, of_curve = (key[0], None) if curve is None else (key[1], key[0])
        rows.append(Against(value, of_curve, spread_of(column), rate, int(group.get_column("run")[0])))
    numeric = table.schema[factor].is_numeric()
    return sorted(rows, key=lambda row: (str(row.curve), row.value if numeric else 0))


def roc(table: pl.DataFrame, who: str, factor: str) -> list[RocPoint]:
    """Return alarms without faults, faults found and their delay, at each value of a factor; by `who` ("detector").

    The runs of one value are one point: those without faults count false alarms, those with faults what was found.
    """
    found = [name for name in table.columns if name.startswith(f"found.{who}.")]
    delays = [name for name in table.columns if name.startswith(f"delay.{who}.")]
    points = []
    for (value,), group in in_classes(table, factor).group_by([factor], maintain_order=True):
        known = group.filter(pl.col(f"alarms.{who}").is_not_null())
        healthy, faulty = known.filter(~pl.col("faulty")), known.filter("faulty")
        raised = int((healthy.get_column(f"alarms.{who}") > 0).sum())
        all_found = int(faulty.select(pl.min_horizontal(found) > 0).to_series().sum()) if found else 0
        delay = pl.concat([faulty.get_column(name).alias("delay") for name in delays]) if delays else pl.Series([])
        points.append(RocPoint(value, rate_of(raised, len(healthy)), rate_of(all_found, len(faulty)), spread_of(delay)))
    return sorted(points, key=lambda point: point.value) if table.schema[factor].is_numeric() else points


def in_classes(table: pl.DataFrame, factor: str) -> pl.DataFrame:
    """Return a table in which a number with many values has the medians of classes of equally many runs."""
    column = table.get_column(factor)
    if not column.dtype.is_numeric() or column.n_unique() <= MOST_VALUES:
        return table
    place = (pl.col(factor).rank("ordinal") - 1) * CLASSES // len(table)
    return table.with_columns(pl.col(factor).median().over(place).alias(factor))


@dataclass(frozen=True)
class OfSize:
    """Faults of one size: how many of them are found, how soon, and the first run there."""

    size: float
    found: Rate
    delay: Spread
    run: int


@dataclass(frozen=True)
class Sizes:
    """A channel's faults by size; `smallest`: see `smallest_found`."""

    channel: str
    points: tuple[OfSize, ...]
    smallest: float | None


def by_size(table: pl.DataFrame, factor: str, who: str, share: float = 0.9) -> list[Sizes]:
    """Return for each channel with faults what is found of each size; `factor`: the column with the sizes."""
    found = []
    for name in (one for one in table.columns if one.startswith(f"found.{who}.")):
        channel = name.removeprefix(f"found.{who}.")
        rates = against(table.filter(pl.col(name).is_not_null()), name, factor)
        delay = f"delay.{who}.{channel}"
        delays = {row.value: row.spread for row in against(table.filter(pl.col(name).is_not_null()), delay, factor)}
        points = tuple(
            OfSize(float(row.value), row.rate, delays[row.value], row.run) for row in rates if row.rate is not None
        )
        found.append(Sizes(channel, points, smallest_found(rates, share)))
    return [one for one in found if one.points]


def sizes_varied(study: Study) -> tuple[str, ...]:
    """Return the columns of factors that are the size of a fault."""
    numbers = (one for one in study.vary if isinstance(one, RangeFactor | ListFactor))
    return tuple(one.column for one in numbers if is_number(one) and fullmatch(r"faults\..+\.size", one.path))


def confusion(table: pl.DataFrame, study: Study, who: str) -> dict[str, dict[str, int]]:
    """Return how often the first alarm named what: true faults → name → runs. "" is an alarm without a name.

    The true faults are the values of the study's factor of faults, or those of its experiment; a run without faults is
    "none", as is a run without an alarm.
    """
    factor = next((one.column for one in study.vary if isinstance(one, FaultsFactor)), None)
    base = study.experiment
    always = "" if isinstance(base, str) else " + ".join(dict.fromkeys(fault.site.name for fault in base.faults))
    counts: dict[str, dict[str, int]] = {}
    wanted = ["faulty", f"name.{who}", f"alarms.{who}", *([factor] if factor else [])]
    for row in table.select(wanted).iter_rows(named=True):
        if row[f"alarms.{who}"] is None:
            continue
        true = (row[factor] if factor else always) if row["faulty"] else "none"
        name = row[f"name.{who}"] if row[f"alarms.{who}"] else "none"
        counts.setdefault(true, {}).setdefault(name or "", 0)
        counts[true][name or ""] += 1
    return counts


def smallest_found(rows: Sequence[Against], share: float = 0.9) -> float | None:
    """Return the smallest size from which on at least a share of the faults are found; None where there is none.

    `rows`: a column `found.…` against the size of its fault. Of sizes below 0 the smallest is the one nearest to 0.
    """
    best = None
    for row in sorted(rows, key=lambda one: abs(float(one.value)), reverse=True):
        if row.rate is None or row.rate.share is None or row.rate.share < share:
            break
        best = float(row.value)
    return best


@dataclass(frozen=True)
class Sensitivity:
    """What a factor does to a measure.

    Args:
        factor: its column.
        rank: Spearman's rank correlation, for numbers; None for names and where nothing varies.
        first: first-order Sobol index, the share of the variance that the factor explains alone; None as above.
    """

    factor: str
    rank: float | None
    first: float | None


def sensitivity(table: pl.DataFrame, study: Study, measure: str) -> list[Sensitivity]:
    """Return what each factor does to a measure, the strongest first.

    The first-order index is estimated from the runs themselves: the variance of the means in classes of the factor,
    less what the scatter within the classes adds to it (Plischke, Reliability Engineering & System Safety 95, 2010).
    """
    found = []
    known = runs_of(table, measure).filter(pl.col(measure).is_not_null() & pl.col(measure).is_finite())
    y = known.get_column(measure).to_numpy().astype(float)
    for one in study.vary:
        column = known.get_column(one.column)
        numeric = column.dtype.is_numeric()
        rank = None
        if numeric and column.n_unique() > 1 and len(np.unique(y)) > 1:
            rank = float(np.asarray(spearmanr(column.to_numpy(), y))[0])
        found.append(Sensitivity(one.column, rank, _first_order(column, y)))
    return sorted(found, key=lambda one: -(one.first or 0.0))


def _first_order(column: pl.Series, y: np.ndarray) -> float | None:
    """Return the share of the variance of y between classes of a column, without the bias of few values a class."""
    if len(y) < 4 or np.var(y) == 0:
        return None
    count = max(4, min(_MOST_CLASSES, int(len(y) ** 0.5)))
    if column.dtype.is_numeric() and column.n_unique() > count:
        ranks = column.rank("ordinal").to_numpy() - 1
        classes = (ranks * count // len(y)).astype(int)
    else:
        classes = column.rank("dense").to_numpy().astype(int)
    labels, counts = np.unique(classes, return_counts=True)
    if len(labels) < 2:
        return None
    means = np.array([y[classes == label].mean() for label in labels])
    inside = sum(float(((y[classes == label] - mean) ** 2).sum()) for label, mean in zip(labels, means, strict=True))
    between = float(counts @ (means - y.mean()) ** 2)
    free = len(y) - len(labels)
    noise = inside / free if free > 0 else 0.0
    total = between + inside
    return max(0.0, min(1.0, (between - (len(labels) - 1) * noise) / total))


@dataclass(frozen=True)
class Compromise:
    """A point of the design by two measures; `best`: no other point is better in one and as good in the other."""

    point: int
    run: int
    a: float
    b: float
    best: bool


def pareto(table: pl.DataFrame, a: str, b: str) -> list[Compromise]:
    """Return the medians of two measures at each point that has both; smaller is better."""
    medians = [
        runs_of(table, name).group_by("point", maintain_order=True).agg(pl.col("run").first(), pl.col(name).median())
        for name in (a, b)
    ]
    firsts, others = (frame.rename({name: "value"}) for frame, name in zip(medians, (a, b), strict=True))
    rows = firsts.join(others, on="point", maintain_order="left", suffix="_b").drop_nulls()
    rows = rows.select("point", "run", "value", "value_b").rows()
    found = []
    for point, run, x, y in rows:
        better = any((u <= x and v <= y) and (u < x or v < y) for _, _, u, v in rows)
        found.append(Compromise(point, run, x, y, not better))
    return found


def runs_of(table: pl.DataFrame, measure: str) -> pl.DataFrame:
    """Return the runs that a measure is about: with faults, or without for false alarms; all if there are none.

    A median over both kinds would mean neither.
    """
    wanted = table.filter(~pl.col("faulty") if measure.startswith(("alarms.", "false.")) else pl.col("faulty"))
    return wanted if len(wanted) else table
