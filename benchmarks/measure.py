"""Measure contenders under equal conditions: in turn, in random order, round after round, in one process."""

import random
import statistics
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One line of the table: median and range of a ratio, or of seconds, and the target."""

    what: str
    median: float
    low: float
    high: float
    target: str = ""
    unit: str = ""

    @classmethod
    def of(cls, what: str, values: Iterable[float], target: str = "", unit: str = "") -> "Figure":
        """Return a figure with the median, the least and the largest of the values."""
        values = list(values)
        return cls(what, statistics.median(values), min(values), max(values), target, unit)

    def text(self) -> str:
        """Return the figure as a line for a terminal."""
        return f"{self.what:72s} {self._short(self.median):>9s}   [{self.range()}]   {self.target}"

    def markdown(self) -> str:
        """Return the figure as a row of a Markdown table."""
        return f"| {self.what} | {self._short(self.median)} | {self.range()} | {self.target} |"

    def range(self) -> str:
        """Return the least and the largest value as text."""
        return f"{self._short(self.low)} … {self._short(self.high)}"

    def _short(self, value: float) -> str:
        if self.unit == "ms":
            return f"{1000 * value:.3g} ms"
        return f"{value:.3g}{' ' if self.unit else ''}{self.unit}"


def rounds(contenders: dict[str, Callable[[], object]], count: int = 15, seed: int = 0) -> dict[str, list[float]]:
    """Return the seconds of each contender in each round, after a warm-up round; short calls run several times.

    Of these repeated calls the fastest counts.
    """
    order, draw = list(contenders), random.Random(seed)
    for run in contenders.values():
        run()
    seconds: dict[str, list[float]] = {name: [] for name in order}
    for _ in range(count):
        draw.shuffle(order)
        for name in order:
            seconds[name].append(_best(contenders[name]))
    return seconds


def _best(run: Callable[[], object], enough: float = 0.05) -> float:
    """Return the fastest of the calls that fit into `enough` seconds: other load can only add time."""
    best, spent = float("inf"), 0.0
    while spent < enough:
        begin = time.perf_counter()
        run()
        took = time.perf_counter() - begin
        best, spent = min(best, took), spent + took
    return best


def ratios(seconds: dict[str, list[float]], name: str, base: str, scale: float = 1.0) -> list[float]:
    """Return `scale` times the seconds of `name` divided by those of `base`, for each round."""
    return [scale * a / b for a, b in zip(seconds[name], seconds[base], strict=True)]
