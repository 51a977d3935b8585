"""Facts and units of observers have words in every language."""

import ast
import re
from pathlib import Path

import pytest

import thetascope.engine.observers as package
from thetascope.engine.observers.registry import kinds, observer
from thetascope.messages.catalogue import catalogue, languages
from thetascope.messages.message import text_of


def fact_names() -> set[str]:
    """Return the names under which the files of observers store facts."""
    names = set()
    for path in Path(package.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            stored = isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store)
            if stored and ast.unparse(node.value).endswith("facts") and isinstance(node.slice, ast.Constant):
                names.add(str(node.slice.value))
    return names


@pytest.mark.parametrize("language", languages())
def test_every_fact_has_a_name(language):
    """The report shows no fact under the name that the code gives it."""
    names = fact_names()
    assert {"relative degree", "K1", "affine"} <= names
    codes = {f"fact.{name.lower().replace(' ', '-')}" for name in names}
    assert codes - set(catalogue(language).templates) == set()


def test_units_have_no_english_word_in_chinese():
    """Units that are made of words are messages: state² is 状态²."""
    units = {text_of(gain.unit.words, "zh") for kind in kinds() for gain in observer(kind).gains}
    assert "状态²" in units and [unit for unit in units if re.search("[a-z]{3}", unit)] == []
