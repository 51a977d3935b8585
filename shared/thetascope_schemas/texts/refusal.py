"""Refusals as codes with arguments: `refuse` for validators, `suggestion` for the nearest known names.

This package has no catalogues. It returns codes of sentences and their arguments; `thetascope.messages` renders them.
"""

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Any

from pydantic_core import PydanticCustomError

MOST_NAMES = 40
"""Maximum number of known names in a suggestion."""


def refuse(code: str, /, field: str = "", value: object = None, **args: Any) -> PydanticCustomError:
    """Return the error that a validator raises.

    Args:
        code: code of the problem, for example `fault.end.before-onset`. The remedy is the entry `code.remedy`.
        field: path below the model that is validated; empty for the model itself.
        value: the offending value; by default the one that pydantic validated.
        args: arguments of the two sentences: numbers, texts, lists of these, or messages as {code, args}.
    """
    context = {"code": code, "args": args, "field": field, "value": value, "shown": readable(code, args)}
    return PydanticCustomError("refused", "{shown}", context)


def suggestion(word: str, known: Iterable[str]) -> dict[str, Any]:
    """Return a message, as {code, args}, with the known names nearest to a word, or else all of them."""
    names = sorted(known)
    near = get_close_matches(word, names, n=3, cutoff=0.6)
    if near:
        return {"code": "suggest.near", "args": {"names": near}}
    if not names:
        return {"code": "suggest.none", "args": {}}
    return {"code": "suggest.more" if len(names) > MOST_NAMES else "suggest.all", "args": {"names": names[:MOST_NAMES]}}


def readable(code: str, args: Mapping[str, Any]) -> str:
    """Return a code with its arguments as text: `fault.end.before-onset(end=5, onset=20)`."""

    def text(value: Any) -> str:
        if isinstance(value, Mapping) and "code" in value:
            return readable(value["code"], value["args"])
        if isinstance(value, list | tuple):
            return f"[{', '.join(text(item) for item in value)}]"
        return f"{value:.6g}" if isinstance(value, float) else str(value)

    shown = ", ".join(f"{name}={text(value)}" for name, value in args.items())
    return f"{code}({shown})" if shown else code
