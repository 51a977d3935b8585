"""The scoreboard as rows of plain values, for CSV and JSON, and as cells, for text and Markdown."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from thetascope.assembly.analyses.seed_trial import Coverage
from thetascope.assembly.benchmark.scores import Score
from thetascope.diagnosis.evaluation.rates import clopper_pearson
from thetascope.messages import Message, text_of

HEAD = ("problem", "way", "found", "false", "wrong", "delay", "size-error", "size-held", "onset-held", "cost", "note")


def records(scores: Sequence[Score], language: str = "en") -> list[dict[str, Any]]:
    """Return one flat dictionary for each row; rates are counts with their number and 95 % interval."""
    return [_record(score, language) for score in scores]


def _record(score: Score, language: str) -> dict[str, Any]:
    tally = score.tally
    row: dict[str, Any] = {"problem": score.problem, "rule": score.rule, "seeds": score.seeds}
    attempts = score.seeds * score.faults
    row |= _rate("found", None if tally is None else sum(tally.found.values()), attempts)
    row |= _rate("false", None if tally is None else tally.without, score.seeds)
    row |= _rate("before", None if tally is None else tally.before, score.seeds)
    row |= {"wrong_names": None if tally is None else tally.wrong}
    row |= {"delay_s": None if tally is None else tally.delay, "size_error": size_error(score)}
    for name in ("size", "onset"):
        held: Coverage = Coverage() if tally is None else getattr(tally, name)
        row |= _rate(f"{name}_held", held.held if held.reported else None, held.reported)
    row |= {"diverged": score.diverged, "cost_s_per_s": score.cost}
    return row | {"note": notes(score, language)}


def _rate(name: str, count: int | None, of: int) -> dict[str, Any]:
    low, high = (None, None) if count is None else clopper_pearson(count, of)
    return {name: count, f"{name}_of": of, f"{name}_low": low, f"{name}_high": high}


def size_error(score: Score) -> float | None:
    """Return the median error of the sizes reported, relative to the true ones; None without any."""
    errors = score.tally.size_errors if score.tally else []
    return float(np.median(errors)) if errors else None


def notes(score: Score, language: str) -> str:
    """Return what went wrong: the runs in which it diverged, and why there are no counts or which assumption fails."""
    said = [Message("bench.diverged", runs=score.diverged, all=2 * score.seeds)] if score.diverged else []
    return "; ".join(text_of(one, language) for one in (*said, score.note) if one is not None)


def cells(scores: Sequence[Score], language: str) -> list[tuple[str, ...]]:
    """Return the rows of the table under HEAD."""
    return [_cells(row) for row in records(scores, language)]


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    error = "–" if row["size_error"] is None else f"{100 * row['size_error']:.2g} %"
    rates = {name: _shown(row, name) for name in ("found", "false", "size_held", "onset_held")}
    wrong = "–" if row["wrong_names"] is None else str(row["wrong_names"])
    delay, cost = ("–" if row[name] is None else f"{row[name]:.3g}" for name in ("delay_s", "cost_s_per_s"))
    counts = (rates["found"], rates["false"], wrong, delay, error, rates["size_held"], rates["onset_held"])
    return row["problem"], row["rule"], *counts, cost, row["note"] or "–"


def _shown(row: dict[str, Any], name: str) -> str:
    """Return a count of a number with its interval in per cent."""
    if row[name] is None:
        return "–"
    low, high = (round(100 * row[f"{name}_{end}"]) for end in ("low", "high"))
    return f"{row[name]}/{row[f'{name}_of']} ({low}–{high} %)"
