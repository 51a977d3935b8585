"""Write a plant as YAML or JSON text that people read and edit."""

import json
from typing import Any

import yaml

from thetascope_schemas.experiment.plant import Plant

_WIDTH = 110
_BLOCKS = ("channels", "controllers", "tables")  # items of these have a line for each field
_EMPTY: tuple[Any, ...] = (None, "", [], {}, [None, None])


class _Dumper(yaml.SafeDumper):
    """YAML without anchors, which plants may not contain; lists are indented."""

    def ignore_aliases(self, data: Any) -> bool:
        """Return that equal values are written twice."""
        return True

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
        """Indent the items of a list below its key."""
        return super().increase_indent(flow, False)


def plant_data(plant: Plant, language: str) -> dict[str, Any]:
    """Return a plant as data with its prose in a language, without the fields that are empty."""
    return _filled(plant.model_dump(mode="json", context={"language": language}))


def _filled(data: dict[str, Any]) -> dict[str, Any]:
    """Return data without empty texts, lists and bounds, which are the defaults."""
    full = {}
    for name, value in data.items():
        if isinstance(value, list):
            value = [_filled(item) if isinstance(item, dict) else item for item in value]
        elif isinstance(value, dict):
            value = _filled(value)
        if value not in _EMPTY:
            full[name] = value
    return full


def yaml_text(data: dict[str, Any]) -> str:
    """Return data of a plant as YAML: a line for each quantity, several for each fault."""
    return "".join(_part(str(name), value) for name, value in _plain(data).items())


def json_text(data: dict[str, Any]) -> str:
    """Return data as JSON, indented."""
    return json.dumps(_plain(data), indent=2, ensure_ascii=False) + "\n"


def _part(name: str, value: Any) -> str:
    if not isinstance(value, list) or not value or not all(isinstance(item, dict) for item in value):
        on_one_line = isinstance(value, dict) and name == "time"
        return f"{flow({name: value})[1:-1]}\n" if on_one_line else _block({name: value})
    lines = [block_item(item) if name in _BLOCKS else f"  - {flow(item)}\n" for item in value]
    return f"{name}:\n" + "".join(lines)


def block_item(item: dict[str, Any], indent: int = 2) -> str:
    """Return an item of a list with a line for each field; maps and lists within are on one line."""
    lines = [f"{flow(name)}: {flow(value)}" for name, value in item.items()]
    return " " * indent + "- " + f"\n{' ' * (indent + 2)}".join(lines) + "\n"


def flow(value: Any) -> str:
    """Return a value as YAML on one line."""
    text = yaml.dump(value, Dumper=_Dumper, default_flow_style=True, width=1e9, allow_unicode=True, sort_keys=False)
    return text.removesuffix("...\n").strip()


def _block(value: dict[str, Any]) -> str:
    return yaml.dump(value, Dumper=_Dumper, default_flow_style=False, width=_WIDTH, allow_unicode=True, sort_keys=False)


def _plain(value: Any) -> Any:
    """Return data whose integral floats are integers, as people write them."""
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return int(value)
    return value
