"""Ratios measured side by side: contenders take turns in random order, round after round, in one process."""

import random
import statistics
import time
from collections.abc import Callable


def rounds(contenders: dict[str, Callable[[], object]], count: int = 15, seed: int = 0) -> dict[str, list[float]]:
    """Seconds of each contender in each round, after one unmeasured round."""
    order, draw = list(contenders), random.Random(seed)
    for run in contenders.values():
        run()
    seconds: dict[str, list[float]] = {name: [] for name in order}
    for _ in range(count):
        draw.shuffle(order)
        for name in order:
            begin = time.perf_counter()
            contenders[name]()
            seconds[name].append(time.perf_counter() - begin)
    return seconds


def ratio(seconds: dict[str, list[float]], name: str, base: str) -> tuple[float, float, float]:
    """Median, minimum and maximum over the rounds of name's time over base's time in the same round."""
    each = [a / b for a, b in zip(seconds[name], seconds[base], strict=True)]
    return statistics.median(each), min(each), max(each)


def line(what: str, value: tuple[float, float, float], bound: str) -> str:
    return f"{what:58s} {value[0]:9.3f}   [{value[1]:.3f} … {value[2]:.3f}]   {bound}"
