"""Catalogues: gettext's .po files, read with Babel; the message's code is the msgid.

A template is the translation of a code. It holds fields in braces, each with an optional format after a colon:

    {name}       the argument as it is; a nested message is rendered in the same language
    {value:.4g}  a number by Python's format: .Ng, .Nf, .N%, `,` for thousands, `+` for the sign
    {names}      a list, joined by the catalogue's `join.comma`; {names:or} and {names:and} join the last item so

A blank that has come to stand between two Chinese characters, as around a name that turned out to be Chinese, is left
out. An entry with plural forms is chosen by the argument `n` and the rule in the catalogue's header. The page renders
the same templates with frontend/i18n/render.js; tests/messages/rendering.json holds both to the same results.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from gettext import c2py
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from babel.core import Locale, negotiate_locale
from babel.messages.catalog import Catalog
from babel.messages.plurals import get_plural
from babel.messages.pofile import read_po

FOLDER = Path(__file__).parent / "locales"
DEFAULT = "en"
_FIELD = re.compile(r"\{(\w+)(?::([^{}]*))?\}|\{\{|\}\}")
_HAN = "[\u3000-\u303f\u4e00-\u9fff\uff00-\uffef]"
_BLANK = re.compile(f"(?<={_HAN}) +(?={_HAN})")


@runtime_checkable
class Coded(Protocol):
    """Anything with a code and arguments: a Message."""

    @property
    def code(self) -> str:
        """The msgid."""
        ...

    @property
    def args(self) -> Mapping[str, Any]:
        """The values that the template shows, by name."""
        ...


class Catalogue:
    """The words of one language: code → template, or a template for each plural form."""

    def __init__(self, language: str, templates: Mapping[str, str | Sequence[str]]) -> None:
        self.language = language
        self.templates = dict(templates)

    def render(self, message: Coded) -> str:
        """Return the sentence of a message. An unknown code is shown with its arguments, so that nothing is lost."""
        template = self.template(message.code, message.args)
        if template is None:
            shown = ", ".join(f"{name}={self._value(value, '')}" for name, value in message.args.items())
            return f"{message.code}({shown})" if shown else message.code

        def field(match: re.Match[str]) -> str:
            if match[1] is None:
                return match[0][0]
            return self._value(message.args.get(match[1]), match[2] or "") if match[1] in message.args else match[0]

        return _BLANK.sub("", _FIELD.sub(field, template))

    def as_data(self) -> dict[str, Any]:
        """Return the catalogue as plain data: language, templates, and the plural rule.

        `plural` lists the categories of Unicode's CLDR (`one`, `other` …) in the order of the plural forms, so that a
        page finds the form of n with `Intl.PluralRules`. A number that is not whole takes the form of 2.
        """
        return {"language": self.language, "plural": _plural_categories(self.language), "messages": self.templates}

    def template(self, code: str, args: Mapping[str, Any]) -> str | None:
        """Return the template of a code, in the plural form that the argument `n` asks for."""
        found = self.templates.get(code)
        if found is None or isinstance(found, str):
            return found
        number = args.get("n", 1)
        return found[min(_plural_index(self.language, number), len(found) - 1)]

    def _value(self, value: Any, format: str) -> str:
        if isinstance(value, Coded):
            return self.render(value)
        if isinstance(value, tuple | list):
            return self._joined(
                [self._value(item, "" if format in ("or", "and") else format) for item in value], format
            )
        if isinstance(value, int | float) and not isinstance(value, bool):
            return f"{value:{format}}" if format else f"{value:.6g}" if isinstance(value, float) else str(value)
        return "–" if value is None else str(value)

    def _joined(self, items: Sequence[str], how: str) -> str:
        comma = str(self.templates.get("join.comma", ", "))
        if how not in ("or", "and") or len(items) < 2:
            return comma.join(items)
        pair = str(self.templates.get(f"join.{how}", "{head}, {last}"))
        return pair.replace("{head}", comma.join(items[:-1])).replace("{last}", items[-1])


@cache
def catalogue(language: str) -> Catalogue:
    """Return the catalogue of a language (`en`, `zh`, `zh-CN` …); English for a language without one."""
    known = language if language in languages() else negotiate([language])
    templates: dict[str, str | Sequence[str]] = {}
    for path in sorted((FOLDER / known).glob("*.po")):
        for entry in _read(path):
            if entry.id and entry.string and "fuzzy" not in entry.flags:
                code = entry.id if isinstance(entry.id, str) else entry.id[0]
                templates[code] = entry.string
    return Catalogue(known, templates)


@cache
def languages() -> tuple[str, ...]:
    """Return the languages that have a catalogue, English first."""
    found = sorted(path.name for path in FOLDER.iterdir() if path.is_dir())
    return (DEFAULT, *(name for name in found if name != DEFAULT))


def negotiate(wanted: Iterable[str]) -> str:
    """Return the first language of a list of tags (`zh-CN`, `en;q=0.5` in their order) that has a catalogue."""
    tags = [tag.split(";")[0].strip().replace("-", "_").lower() for tag in wanted]
    return negotiate_locale([tag for tag in tags if tag], languages(), sep="_") or DEFAULT


def _read(path: Path) -> Catalog:
    with path.open("rb") as file:
        return read_po(file, locale=path.parent.name)


@cache
def _plural_rule(language: str) -> Callable[[int], int]:
    """Return gettext's plural rule of a language: a number → the index of its form."""
    return c2py(get_plural(language).plural_expr)


def _plural_index(language: str, number: Any) -> int:
    """Return which plural form a number takes; a fraction takes that of 2."""
    whole = isinstance(number, int) or (isinstance(number, float) and number.is_integer())
    return _plural_rule(language)(abs(int(number)) if whole else 2)


def _plural_categories(language: str) -> list[str]:
    """Return the CLDR category of each plural form of a language, in gettext's order."""
    category, index = Locale(language).plural_form, _plural_rule(language)
    forms = {index(number): category(number) for number in reversed(range(200))}
    return [forms[form] for form in range(len(forms))]
