"""Names of columns: their unit, the words in them, and how well they fit a quantity of a plant."""

import re
import unicodedata
from functools import cache

from thetascope.records.columns.units import is_unit


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


_BRACKET = re.compile(r"^(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*(?:\([^()]*\)[^()]*)*)\)|<([^<>]*)>)\s*$")
_LAST = re.compile(r"^(.*?)(?:\s*[,/]\s+|\s+in\s+|\s+)(\S+)$")
_JOINED = re.compile(r"^(.+)_([A-Za-z%]+)$")
_SUFFIXES = _set(
    "cm mm km ms us ns min sec hr hours degC degF bar mbar kPa Pa psi rpm lpm gpm mV mA kW kg pct percent Hz"
)
_DISTINCT = re.compile(r"[°%/]|[A-Za-z]\d$|[²³]")
_EPOCH = frozenset(("utc", "gmt", "local", "iso", "iso8601", "epoch", "unix", "posix"))
_WORD = re.compile(r"[^\W\d_]+|\d+")
_HAN = re.compile(r"[\u3400-\u9fff]+")
_SMALL = _set("of the a an in at to for and is measured value signal sensor reading data actual that asked")
_ALIKE = {
    word: group
    for group, words in {
        "level": "level height h lvl liquid 液位 水位 高度 lt li",
        "flow": "flow inflow pump q flowrate feed rate 流量 泵 ft fi",
        "temperature": "temperature temp t 温度 tt ti tc",
        "pressure": "pressure p press 压力 压强 pt pi",
        "speed": "speed velocity omega ω n rpm 转速 速度 角速度",
        "voltage": "voltage volt volts u v 电压",
        "current": "current amp amps i 电流",
        "torque": "torque moment tau 转矩 力矩",
        "position": "position pos displacement x 位置 位移",
        "angle": "angle phi theta 角度 转角",
        "heater": "heater heating power duty 加热 功率 加热器",
        "valve": "valve opening 阀 阀门 开度",
        "concentration": "concentration conc c 浓度",
        "acceleration": "acceleration acc accel 加速度",
        "tank": "tank vessel 罐 水箱 容器",
    }.items()
    for word in words.split()
}
_KNOWN_HAN = sorted((word for word in _ALIKE if _HAN.fullmatch(word)), key=len, reverse=True)
KINDS = frozenset(_ALIKE.values()) - {"tank"}
"""Kinds of quantities that names tell."""
_SET_POINTS = _set(
    "sp spt setpoint setpt set ref reference target goal desired 设定 设定值 给定 目标 soll error err status alarm mode"
)
_TIMES = _set(
    "t time timestamp datetime date seconds sec secs elapsed ts clock zeit xvalue temps tiempo minutes min "
    "hours millis ms utc epoch moment 时间 时刻 日期 时间戳"
)


@cache
def split_unit(header: str) -> tuple[str, str]:
    """Return the name without its unit, and the unit as written; empty where none is written."""
    text = unicodedata.normalize("NFKC", header).strip()
    match = _BRACKET.match(text)
    if match:
        inside = next(group for group in match.groups()[1:] if group is not None).strip()
        bare = match[1].strip()
        if bare and (is_unit(inside) or inside in ("", "-") or inside.lower() in _EPOCH):
            return bare, "" if inside in ("-",) else inside
        return text, ""
    match = _LAST.match(text)
    if match and is_unit(match[2]) and match[1].strip():
        separate = not text[len(match[1]) :].startswith(" " + match[2])
        if separate or _DISTINCT.search(match[2]) or match[2] in _SUFFIXES:
            return match[1].strip(), match[2]
    match = _JOINED.match(text)
    if match and match[2] in _SUFFIXES and is_unit(match[2]):
        return match[1], match[2]
    return text, ""


def _of_han(text: str) -> set[str]:
    """Return the words in Chinese characters: those that are known, the longest first, and pairs of the others."""
    words = set()
    for part in _KNOWN_HAN:
        if part in text:
            words.add(_ALIKE[part])
            text = text.replace(part, " ")
    for rest in text.split():
        words |= {rest[k : k + 2] for k in range(len(rest) - 1)} or {rest}
    return words


@cache
def words_of(text: str) -> frozenset[str]:
    """Return the words of a name or description, without case, with words of the same meaning as one."""
    text = unicodedata.normalize("NFKC", text)
    text = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text).casefold()
    words: set[str] = set()
    for word in _WORD.findall(text):
        for han in _HAN.findall(word):
            words |= _of_han(str(han))
        if not _HAN.search(word) and word not in _SMALL:
            words.add(str(_ALIKE.get(word, word)) if len(word) > 1 else str(word))
    return frozenset(words)


def plain(name: str) -> str:
    """Return a name without case, blanks, and signs."""
    return re.sub(r"[\W_]+", "", unicodedata.normalize("NFKC", name).casefold())


def is_set_point(header: str) -> bool:
    """Return whether a name is that of a set point, a control error or a state of the logger."""
    return bool(words_of(header) & _SET_POINTS) or any(word in header for word in ("设定", "给定", "目标"))


def is_time_name(header: str) -> bool:
    """Return whether a name is that of times."""
    words = words_of(split_unit(header)[0]) | {plain(split_unit(header)[0])}
    return bool(words & _TIMES) or any(word in header for word in ("时间", "时刻", "日期"))
