"""Confidence intervals of rates that are counted: k of n."""

from scipy.stats import beta

LEVEL = 0.95


def clopper_pearson(count: int, of: int, level: float = LEVEL) -> tuple[float, float]:
    """Return the exact two-sided interval of a probability from `count` successes in `of` independent attempts.

    Its coverage is at least `level` whatever the probability is. Without attempts it is (0, 1).
    """
    tail = (1 - level) / 2
    low = float(beta.ppf(tail, count, of - count + 1)) if count > 0 else 0.0
    high = float(beta.ppf(1 - tail, count + 1, of - count)) if count < of else 1.0
    return low, high
