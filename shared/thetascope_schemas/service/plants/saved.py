"""Plants that clients have saved on the server."""

from typing import Any

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict, example
from thetascope_schemas.service.plants.text import TextFormat

_LINE: dict[str, Any] = {
    "id": "two-tanks",
    "version": 7,
    "title": "Two tanks in a row",
    "format": "yaml",
    "faults": 3,
    "ready": True,
    "saved": 1795960920.0,
    "mine": True,
    "href": "/api/my-plants/two-tanks?version=7",
}


class MyPlantLine(Strict):
    """A version of a saved plant, without its text."""

    model_config = example(**_LINE)

    id: str = Field(description="Id in the text, by which experiments and records name the plant.")
    version: int = Field(description="Number of the version, from 1; `id@version` names it.")
    title: str
    format: TextFormat
    faults: int = Field(description="Number of fault channels; 0 in a draft that cannot be read.")
    ready: bool = Field(description="Whether it had no errors when it was saved; a draft cannot be simulated.")
    saved: Number = Field(description="Time in seconds since 1970.")
    mine: bool = Field(description="Whether this client may delete it; others' plants can be read and used.")
    href: str


class MyPlantList(Strict):
    """Saved plants, or the versions of one of them, the last one that was saved first."""

    model_config = example(plants=[_LINE])

    plants: tuple[MyPlantLine, ...]


class MyPlant(MyPlantLine):
    """A version of a saved plant with its text."""

    model_config = example(**_LINE, text="id: two-tanks")

    text: str = Field(description="The plant as YAML or JSON, as it was typed.")
