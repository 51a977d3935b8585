"""A message becomes a sentence by its template, in every language and for every kind of argument."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

from thetascope.engine.errors import SpecError
from thetascope.messages import Message, text_of
from thetascope.messages.catalogue import Catalogue, catalogue, languages, negotiate
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.texts.local_text import LocalText

ROWS = json.loads(Path(__file__).with_name("rendering.json").read_text(encoding="utf-8"))["rows"]


def argument(value):
    """Return an argument of a row of the table; {code, args} is a nested message."""
    if isinstance(value, list):
        return [argument(item) for item in value]
    if isinstance(value, dict):
        return Message(value["code"], **value["args"])
    return value


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['template']}-{row['args']}-{row['language']}")
def test_a_template_renders_as_the_table_says(row):
    """The page's renderer is tested with the same table."""
    words = Catalogue(row["language"], {**catalogue(row["language"]).templates, "test": row["template"]})
    args = {name: argument(value) for name, value in row["args"].items()}
    assert words.render(Message("test", **args)) == row["expected"]


def test_a_message_is_english_by_default_and_chinese_on_request():
    """str() is English; a language without a catalogue is answered in English."""
    message = Message("common.states", n=1)
    assert str(message) == "1 state"
    assert message.text("zh") == message.text("zh-CN") == "1 个状态"
    assert message.text("fr") == "1 state"


def test_a_message_is_a_value():
    """It compares by code and arguments, does not change, and survives pickling and plain data with what it nests."""
    inner = Message("common.states", n=2)
    message = Message("a.b", part=inner, names=["u", "y"], size=np.float64(0.5), count=np.int64(3), none=None)
    assert message == Message("a.b", part=inner, names=("u", "y"), size=0.5, count=3, none=None)
    assert message != Message("a.b") and len({message, Message("a.b")}) == 2
    assert type(message.args["size"]) is float and type(message.args["count"]) is int
    assert pickle.loads(pickle.dumps(message)) == message
    assert Message.from_data(json.loads(json.dumps(message.as_data()))) == message
    with pytest.raises(AttributeError):
        message.code = "other"
    with pytest.raises(TypeError, match="cannot hold"):
        Message("a.b", value={1, 2})


def test_the_wire_carries_code_arguments_and_the_sentence():
    """Text.of makes the wire's form of a message in a language."""
    text = Text.of(Message("common.states", n=3), "zh")
    assert text.model_dump() == {"code": "common.states", "args": {"n": 3}, "text": "3 个状态"}


@pytest.mark.parametrize(
    ("wanted", "language"),
    [
        (["zh"], "zh"),
        (["zh-CN"], "zh"),
        (["zh_TW.UTF-8"], "zh"),
        (["ZH-Hans-CN"], "zh"),
        (["fr"], "en"),
        (["fr", "zh;q=0.5"], "zh"),
        (["en-GB", "zh"], "en"),
        (["*"], "en"),
        ([""], "en"),
        ([], "en"),
        (["../..", "\x00", "zh" * 5000], "en"),
    ],
)
def test_the_first_language_with_a_catalogue_is_used(wanted, language):
    """Tags of browsers and of LANG are understood; the default is English."""
    assert negotiate(wanted) == language


def test_plural_categories_are_in_the_order_of_the_forms():
    """A page finds the form of n by Intl.PluralRules and this list."""
    assert languages() == ("en", "zh")
    assert catalogue("en").as_data()["plural"] == ["one", "other"]
    assert catalogue("zh").as_data()["plural"] == ["other"]
    assert catalogue("zh").as_data()["messages"]["common.states"] == ("{n} 个状态",)


def test_an_error_of_the_engine_has_a_message_and_never_prose():
    """No refusal can lack a language; the remedy follows from the problem, and pickling keeps both."""
    error = SpecError("faults[0].end", 5, Message("fault.end.before-onset", end=5, onset=20))
    assert error.remedy == Message("fault.end.before-onset.remedy", end=5, onset=20)
    assert pickle.loads(pickle.dumps(error)).remedy == error.remedy
    with pytest.raises(TypeError, match="Message"):
        SpecError("faults[0].end", 5, "the end is not after the onset", "give a later end")


def test_every_kind_of_text_is_rendered_in_a_language():
    """Messages, their form on the wire and as data, texts in several languages, and plain texts."""
    message = Message("common.states", n=2)
    forms = (message, Text.of(message), message.as_data(), LocalText({"en": "2 states", "zh": "2 个状态"}))
    for value in forms:
        assert (text_of(value), text_of(value, "zh")) == ("2 states", "2 个状态")
    assert text_of("as it is", "zh") == "as it is"
