"""The library's texts have their languages as data."""

import re
from collections.abc import Iterator

import pytest

from thetascope import library
from thetascope_schemas import Plant
from thetascope_schemas.experiment.base import Strict
from thetascope_schemas.texts.local_text import ALL, LocalText, in_language

WORD = re.compile(r"(?<![A-Za-z0-9_])[a-z]{3,}(?![A-Za-z0-9_])")
CJK = re.compile("[\u3400-\u9fff]")
ITEMS = [*library.plants().values(), *library.experiments().values()]
PROSE = {"title", "description", "source", "errata", "caption"}


def prose(item: object, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield every text of an item for readers, with its path."""
    if isinstance(item, Strict):
        for name in type(item).model_fields:
            value = getattr(item, name)
            if name in PROSE and isinstance(value, str) and value:
                yield f"{path}.{name}", value
            elif name in PROSE and isinstance(value, tuple):
                yield from ((f"{path}.{name}[{index}]", text) for index, text in enumerate(value))
            else:
                yield from prose(value, f"{path}.{name}")
    elif isinstance(item, tuple):
        for index, part in enumerate(item):
            yield from prose(part, f"{path}[{index}]")


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: f"{type(item).__name__}-{item.id}")
def test_every_text_of_the_library_has_chinese(item):
    """Titles, descriptions, sources, errata and captions; a text of symbols alone needs none."""
    texts = dict(prose(item))
    assert texts
    for path, text in texts.items():
        if WORD.search(text):
            assert isinstance(text, LocalText) and CJK.search(text.texts["zh"]), path
            assert not CJK.search(text), path


def test_a_text_may_be_a_map_of_languages_wherever_prose_is_expected():
    """It is a str, its English; JSON has one language, or with ALL the whole map, and reading that gives it back."""
    data = library.plant("dc-motor").model_dump() | {"title": {"en": "Motor", "zh": "电机"}}
    plant = Plant.model_validate(data)
    assert plant.title == "Motor" and isinstance(plant.title, str)
    assert in_language(plant.title, "zh") == "电机" and in_language(plant.title, "fr") == "Motor"
    written = {language: plant.model_dump(mode="json", context={"language": language}) for language in ("zh", ALL)}
    assert plant.model_dump(mode="json")["title"] == "Motor"
    assert written["zh"]["title"] == "电机"
    assert written[ALL]["title"] == {"en": "Motor", "zh": "电机"}
    assert Plant.model_validate(written[ALL]) == plant
    assert Plant.model_validate(written[ALL]).title.texts == plant.title.texts


def test_languages_change_no_id():
    """Prose is not part of a spec's hash, in any language."""
    spec = library.experiment("zhao-2012").with_plant(library.plant("zhao-contois"))
    chinese = type(spec).model_validate(spec.model_dump(mode="json", context={"language": "zh"}))
    assert chinese.title != spec.title and chinese.spec_hash() == spec.spec_hash()
