"""Cells of text: numbers in any notation, signs for missing values, and times."""

import re
from math import isfinite
from typing import Literal

Decimal = Literal[".", ","]

MISSING = frozenset(
    (
        *(
            "",
            "-",
            "--",
            "---",
            "----",
            "?",
            "*",
            ".",
            "...",
            "na",
            "n/a",
            "n.a.",
            "#n/a",
            "#na",
            "nan",
            "-nan",
            "nan(ind)",
        ),
        *("null", "none", "nil", "nat", "missing", "void", "inf", "-inf", "+inf", "infinity", "-infinity"),
        *("1.#inf", "-1.#inf", "1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan", "#div/0!", "#value!", "#ref!", "#num!"),
        *("#name?", "#null!", "no data", "nodata", "bad", "bad input", "error", "err", "fault", "overflow", "ovf"),
        *("overrange", "underrange", "ol", "i/o timeout", "timeout", "invalid", "not connected", "comm fail", "n/c"),
        *("无", "空", "缺失", "无数据", "错误"),
    )
)
"""Cells, in lower case, that say that there is no value."""

_SWITCH = {
    **dict.fromkeys(("true", "on", "yes", "开", "是"), 1.0),
    **dict.fromkeys(("false", "off", "no", "关", "否"), 0.0),
}

_BLANKS = str.maketrans({"\u00a0": " ", "\u202f": " ", "\u2009": " ", "\u2212": "-", "\uff0d": "-", "\u2013": "-"})
_SPACED = re.compile(r"[+-]?\d{1,3}(?:[ '’]\d{3})+(?:[.,]\d+)?(?:[eE][+-]?\d+)?")
_COMMAS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d*)?(?:[eE][+-]?\d+)?")  # 1,050.5
_DOTS = re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+(?:,\d*)?(?:[eE][+-]?\d+)?")  # 1.050,5
_COMMA = re.compile(r"[+-]?(?:\d+,\d+|,\d+)(?:[eEdD][+-]?\d+)?")  # 1050,5
_PLAIN = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?")
_SUFFIXED = re.compile(
    r"([+-]?[\d.,]*\d[.,]?(?:[eE][+-]?\d+)?)\s*"
    r"([%°℃a-zA-ZμµΩ][%°a-zA-ZμµΩ0-9/²³^·*]{0,9}|秒|分|分钟|小时|毫秒|米|厘米|毫米|度|摄氏度|升|毫升|帕|千帕|伏|安|瓦|千瓦|转)"
)
_SURE_COMMA = re.compile(
    r"[+-]?(?:0,\d+|\d+,\d{1,2}|\d+,\d{4,}|\d{4,},\d+|,\d+|\d{1,3}(?:\.\d{3})+,\d+)(?:[eE][+-]?\d+)?"
)
_SURE_DOT = re.compile(
    r"[+-]?(?:0\.\d+|\d+\.\d{1,2}|\d+\.\d{4,}|\d{4,}\.\d+|\.\d+|\d{1,3}(?:,\d{3})+\.\d+)(?:[eE][+-]?\d+)?"
)
_TIMES = re.compile(
    r"(?=.*\d)(?:\d{1,4}[-/.年]\d{1,2}[-/.月]\d{1,4}日?(?:[T ,]+\d{1,2}[:时]\d{1,2}.*)?"
    r"|\d+:\d{2}(?::\d{2})?(?:[.,]\d+)?(?:\s*[AaPp]\.?[Mm]\.?)?"
    r"|\d+ days?,? ?\d+:\d{2}.*|\d{1,2}[-/ ][A-Za-z]{3,9}[-/ ]\d{2,4}.*|\d{8}T\d{4,6}.*)"
)


def clean(cell: str) -> str:
    """Return a cell without blanks and quotes around it, with plain minus signs."""
    if not cell.isascii():
        cell = cell.translate(_BLANKS)
    cell = cell.strip()
    if len(cell) > 1 and cell[0] == cell[-1] and cell[0] in "\"'":
        cell = cell[1:-1].strip()
    return cell


def is_missing(cell: str) -> bool:
    """Return whether a cell says that there is no value."""
    return cell.lower() in MISSING


def number(cell: str, decimal: Decimal) -> float | None:
    """Return the number in a clean cell, or None. `decimal` decides where 1,234 could be both."""
    if _PLAIN.fullmatch(cell) and not (decimal == "," and _DOTS.fullmatch(cell)):
        return _float(cell)
    if _SPACED.fullmatch(cell):
        return _float(re.sub(r"[ '’]", "", cell).replace(",", "."))
    if decimal == ",":
        if _DOTS.fullmatch(cell):
            return _float(cell.replace(".", "").replace(",", "."))
        if _COMMA.fullmatch(cell):
            return _float(cell.replace(",", "."))
    if _COMMAS.fullmatch(cell):
        return _float(cell.replace(",", ""))
    if _COMMA.fullmatch(cell):
        return _float(cell.replace(",", "."))
    if _DOTS.fullmatch(cell):
        return _float(cell.replace(".", "").replace(",", "."))
    return None


def _float(text: str) -> float | None:
    value = float(text.replace("d", "e").replace("D", "e"))
    return value if isfinite(value) else None


def switch(cell: str) -> float | None:
    """Return 1 or 0 for a word such as on or false, else None."""
    return _SWITCH.get(cell.lower())


def with_unit(cell: str, decimal: Decimal) -> tuple[float, str] | None:
    """Return the number and the unit of a cell such as 20.5 °C, or None."""
    match = _SUFFIXED.fullmatch(cell)
    value = number(match[1], decimal) if match else None
    return None if match is None or value is None else (value, match[2].strip())


def is_time(cell: str) -> bool:
    """Return whether a clean cell looks like a date or a time of day."""
    if len(cell) < 4 or not cell[0].isdigit() or number(cell, ".") is not None:
        return False
    return _TIMES.fullmatch(cell) is not None


def decimal_evidence(cell: str) -> Literal[".", ",", ""]:
    """Return the decimal sign that a clean cell proves, or nothing."""
    if _SURE_DOT.fullmatch(cell):
        return "."
    return "," if _SURE_COMMA.fullmatch(cell) else ""
