"""What forms need to know about the kinds of observers."""

from dataclasses import asdict

from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.observers.support.declaration import Gain, Observer, Option


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
    plain["size"] = gain.size.__doc__ if callable(gain.size) else gain.size
    return plain


def _option(option: Option) -> dict:
    plain = asdict(option)
    plain["default"] = None if callable(option.default) else option.default
    return plain
