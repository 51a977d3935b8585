"""Units in text: what a unit measures, and the conversion between two units of the same dimension."""

import re
import unicodedata
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from typing import Any

_LONGEST = 40
_POWER = 12.0  # larger exponents are no units
_NAMES = {
    **dict.fromkeys(("sec", "secs", "second", "seconds", "秒"), "s"),
    **dict.fromkeys(("mins", "minute", "minutes", "分钟", "分"), "min"),
    **dict.fromkeys(("hr", "hrs", "hour", "hours", "小时", "时"), "h"),
    **dict.fromkeys(("msec", "毫秒", "millis", "milliseconds"), "ms"),
    **dict.fromkeys(("usec", "微秒"), "us"),
    **dict.fromkeys(("day", "days", "天", "日"), "d"),
    **dict.fromkeys(("rev", "revs", "r", "U", "转"), "revolution"),
    **dict.fromkeys(("RPM", "rpm", "revs/min"), "rpm"),
    **dict.fromkeys(("l", "L", "liter", "litre", "升"), "liter"),
    **dict.fromkeys(("ml", "mL", "毫升"), "milliliter"),
    **dict.fromkeys(("cc", "ccm"), "cm^3"),
    **dict.fromkeys(("米", "metre", "metres"), "m"),
    **dict.fromkeys(("厘米",), "cm"),
    **dict.fromkeys(("毫米",), "mm"),
    **dict.fromkeys(("帕",), "Pa"),
    **dict.fromkeys(("千帕",), "kPa"),
    **dict.fromkeys(("兆帕",), "MPa"),
    **dict.fromkeys(("巴", "barg", "bara", "Bar", "BAR"), "bar"),
    **dict.fromkeys(("伏",), "V"),
    **dict.fromkeys(("安",), "A"),
    **dict.fromkeys(("瓦",), "W"),
    **dict.fromkeys(("千瓦",), "kW"),
    **dict.fromkeys(("Nm", "牛米"), "N*m"),
    **dict.fromkeys(("pct", "Percent", "PCT", "百分比"), "percent"),
    **dict.fromkeys(("°", "deg", "Deg", "度"), "degree"),
    **dict.fromkeys(("ohm", "Ohm", "Ω", "Ω"), "ohm"),
    **dict.fromkeys(("in", "inch", "inches"), "inch"),
    **dict.fromkeys(("PSI", "psig", "psia"), "psi"),
    "lpm": "liter/min",
    "LPM": "liter/min",
    "slpm": "liter/min",
    "gpm": "gallon/min",
    "GPM": "gallon/min",
    "sccm": "cm^3/min",
    "Celsius": "°C",
    "kph": "km/h",
    "-": "",
}
_CELSIUS, _FAHRENHEIT = (1.0, 273.15), (5 / 9, 459.67 * 5 / 9)
_TEMPERATURES = {
    **dict.fromkeys(("°C", "degC", "deg C", "C", "celsius", "摄氏度", "DegC", "°c", "oC"), _CELSIUS),
    **dict.fromkeys(("°F", "degF", "deg F", "F", "fahrenheit", "Fahrenheit", "华氏度"), _FAHRENHEIT),
    **dict.fromkeys(("K", "kelvin", "Kelvin", "开尔文", "开"), (1.0, 0.0)),
    **dict.fromkeys(("°R", "degR"), (5 / 9, 0.0)),
}
_LONE = frozenset(("C", "F"))  # degrees where a temperature is meant, else coulomb and farad
_KELVIN = (("kelvin", 1.0),)
_NEXT_POWER = {"": "²", "²": "³", "^2": "^3", "2": "3"}
_TOKEN = re.compile(
    r"\s*(?:(?P<op>[*/·⋅×])|(?P<open>\()|(?P<close>\))|(?P<one>1(?=\s*/))"
    r"|(?P<name>[^\W\d_]+|%|‰|°[A-Za-z]?)(?:(?:\^|\*\*)?(?P<power>-?\d+(?:\.\d+)?))?)"
)
_CHOICES = (
    *("m", "cm", "mm", "in", "ft", "cm³/s", "L/min", "L/s", "L/h", "m³/s", "m³/h", "mL/min", "gpm", "°C", "K", "°F"),
    *("Pa", "kPa", "mbar", "bar", "psi", "rad/s", "rpm", "°/s", "rad", "°", "V", "mV", "A", "mA", "W", "kW", "N m"),
    *("kg", "g", "g/L", "mg/L", "kg/m³", "1/s", "1/min", "1/h", "m/s", "cm/s", "km/h", "m/s²", "cm²", "m²", "cm³", "L"),
    *("kg/s", "kg/h", "g/s", "N", "kN", "Hz", "%", "1", "s", "min", "h", "mol/L", "mol/m³"),
)


@dataclass(frozen=True)
class Scale:
    """A unit: a value x in it is factor · x + offset in base units; `dimension` has the base units with powers."""

    factor: float
    offset: float
    dimension: tuple[tuple[str, float], ...]


@cache
def scale_of(text: str, temperature: bool = False) -> Scale | None:
    """Return the unit that a text writes, or None. `temperature`: whether C and F are degrees."""
    text = unicodedata.normalize("NFKC", text).replace("−", "-").replace("µ", "μ").strip()
    text = " ".join(text.split())
    if len(text) > _LONGEST:
        return None
    if text in _TEMPERATURES and (temperature or text not in _LONE):
        return Scale(*_TEMPERATURES[text], _KELVIN)
    if text in ("", "1", "-", "[]", "none"):
        return Scale(1.0, 0.0, ())
    return _product(text)


def _product(text: str) -> Scale | None:
    """Return the unit of a product of named units with powers, read from left to right."""
    factor, powers = 1.0, {}
    place, sign, depth, first_sign = 0, 1, 0, 1
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            return None
        place = match.end()
        if match["op"]:
            sign = (-1 if match["op"] == "/" else 1) * (first_sign if depth else 1)
        elif match["open"]:
            depth, first_sign = depth + 1, sign
        elif match["close"]:
            depth, sign, first_sign = depth - 1, first_sign, 1
        elif match["name"]:
            power = float(match["power"] or 1)
            unit = _named(match["name"])
            if unit is None or abs(power) > _POWER:
                return None
            factor *= unit.factor ** (sign * power)
            for base, own in unit.dimension:
                powers[base] = powers.get(base, 0.0) + sign * power * own
    if depth or not 0 < factor < float("inf"):
        return None
    return Scale(factor, 0.0, tuple(sorted((b, p) for b, p in powers.items() if abs(p) > 1e-9)))


def per_second(unit: str) -> str:
    """Return the unit of the rate of a quantity: m/s for m, rad/s² for rad/s, 1/s without a unit."""
    if not unit:
        return "1/s"
    before, slash, power = unit.rpartition("/s")
    if slash and power in _NEXT_POWER:
        return f"{before}/s{_NEXT_POWER[power]}"
    return f"{unit}/s"


def nearest_unit(text: str) -> str | None:
    """Return the known unit that is written most like a text that is not known, or None."""
    product = re.sub(r"([A-Za-z]{1,2})([A-Za-z])(\d?)$", r"\1·\2\3", text)  # kgm2 for kg·m²
    if product != text and scale_of(product) is not None:
        return product.replace("2", "²").replace("3", "³")
    near = get_close_matches(text, _CHOICES, n=1, cutoff=0.6)
    return near[0] if near else None


@cache
def _named(name: str) -> Scale | None:
    """Return the unit of one name; temperatures are differences here."""
    if name in _TEMPERATURES and name not in _LONE:
        return Scale(_TEMPERATURES[name][0], 0.0, _KELVIN)
    known = _NAMES.get(name)
    if known is not None and known != name:
        return _product(known) if re.search(r"[*/^]", known) else _named(known) or _of_pint(known)
    return _of_pint(name)


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def _of_pint(name: str) -> Scale | None:
    """Return a unit of pint's registry by its name. Only single names get here, never expressions."""
    if not re.fullmatch(r"[A-Za-zμΩ%‰]{1,30}", name):
        return None
    registry = _registry()
    try:
        factor, base = registry.get_root_units(registry.Unit({"‰": "permille", "%": "percent"}.get(name, name)))
    except Exception:  # pint has no common base of its errors
        return None
    if not isinstance(factor, int | float):
        return None
    bases = registry.Unit(base)._units.items()
    dimension = tuple(sorted((str(b), float(p)) for b, p in bases if b not in ("radian", "count")))
    return Scale(float(factor), 0.0, dimension)


def conversion(source: str, target: str) -> tuple[float, float] | None:
    """Return factor and offset from one unit to another, or None if they do not measure the same."""
    goal = scale_of(target, temperature=True)
    if source.strip() == target.strip():
        return 1.0, 0.0
    warm = goal is not None and goal.dimension == _KELVIN
    start = scale_of(source, temperature=warm)
    if goal is None or start is None or goal.dimension != start.dimension:
        return None
    factor = start.factor / goal.factor
    return _rounded(factor), _rounded((start.offset - goal.offset) / goal.factor)


def _rounded(value: float) -> float:
    """Return a factor without the error of the last digits: 99.99999999999999 becomes 100."""
    return float(f"{value:.15g}")


def choices(target: str) -> tuple[str, ...]:
    """Return units that can be converted to a plant's unit, itself first."""
    result = [target]
    for unit in _CHOICES:
        pair = conversion(unit, target)
        if pair is not None and (pair != (1.0, 0.0)):
            result.append(unit)
    return tuple(result)


def is_unit(text: str) -> bool:
    """Return whether a text writes a unit."""
    return bool(text.strip()) and scale_of(text, temperature=True) is not None
