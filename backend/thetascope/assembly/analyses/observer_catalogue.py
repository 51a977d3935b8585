"""The kinds of observers as data for forms."""

from dataclasses import fields

from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.observers.support.declaration import Count, Gain, Observer, Option, counted_by
from thetascope.messages import text_of


def observer_kinds(language: str = "en") -> list[dict]:
    """Return every kind with its gains (meaning, default, bounds), options and source as plain JSON, in a language."""
    return [_kind(observer(kind), language) for kind in kinds()]


def _kind(kind: Observer, language: str) -> dict:
    return {
        "id": kind.id,
        "title": text_of(kind.title, language),
        "source": text_of(kind.source, language),
        "summary": text_of(kind.summary, language),
        "when": text_of(kind.when, language),
        "time": kind.time,
        "estimates_theta": kind.estimates_theta,
        "takes_channels": kind.takes_channels,
        "residuals": kind.residuals,
        "chooses": kind.chooses is not None,
        "gains": [_gain(g, language) for g in kind.gains],
        "options": [_option(o, language) for o in kind.options],
    }


def _gain(gain: Gain, language: str) -> dict:
    plain = {field.name: getattr(gain, field.name) for field in fields(gain)}
    plain["meaning"], plain["unit"] = text_of(gain.meaning, language), text_of(gain.unit.words, language)
    plain["default"] = None if callable(gain.default) else gain.default  # None: it depends on plant and noise
    plain["size"], plain["columns"] = _counted(gain.size, language), _counted(gain.columns, language)
    del plain["rows"], plain["orders"]  # labels depend on the plant, see POST /api/gains
    return plain


def _counted(size: Count | None, language: str) -> str | None:
    """Return n, m, p, …, or the meaning of the function that counts, in a language."""
    return counted_by(size).text(language) if callable(size) else size


def _option(option: Option, language: str) -> dict:
    plain = {field.name: getattr(option, field.name) for field in fields(option)}
    plain["meaning"] = text_of(option.meaning, language)
    plain["default"] = None if callable(option.default) else option.default
    return plain
