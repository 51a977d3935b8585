"""What forms need to know about the kinds of observers."""

from dataclasses import asdict

from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.observers.support.declaration import Count, Gain, Observer, Option


def observer_kinds() -> list[dict]:
    """Every kind with its gains (meaning, default, bounds), options and source; plain JSON."""
    return [_kind(observer(kind)) for kind in kinds()]


def _kind(kind: Observer) -> dict:
    return {
        "id": kind.id,
        "title": kind.title,
        "source": kind.source,
        "summary": kind.summary,
        "time": kind.time,
        "estimates_theta": kind.estimates_theta,
        "gains": [_gain(g) for g in kind.gains],
        "options": [_option(o) for o in kind.options],
    }


def _gain(gain: Gain) -> dict:
    plain = asdict(gain)
    plain["default"] = None if callable(gain.default) else gain.default  # None: it depends on plant and noise
    plain["size"], plain["columns"] = _counted(gain.size), _counted(gain.columns)
    del plain["rows"]  # labels depend on the plant: POST /api/gains
    return plain


def _counted(size: Count | None) -> str | None:
    """Return n, m, p, …, or the docstring of the function that counts."""
    return size.__doc__ if callable(size) else size


def _option(option: Option) -> dict:
    plain = asdict(option)
    plain["default"] = None if callable(option.default) else option.default
    return plain
