"""Plant and experiment files: read safely, with errors located in the text."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.runs.specs.spec_files import DocumentError, Place, parse, read
from thetascope_schemas.service.field_error import FieldError

TEXT = st.text(st.characters(min_codepoint=32, max_codepoint=0xD7FF, exclude_characters="\x7f\x85\xa0"), max_size=8)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False) | TEXT,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3),
    max_leaves=12,
)


@given(JSON)
def test_json_text_gives_its_data(data):
    """JSON files are read by the YAML reader, which must not interpret them differently."""
    assert parse(json.dumps(data)).data == data


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001),
        ("1E5", 1e5),
        (".5", 0.5),
        ("-3", -3),
        ("012", 12),
        ("0x1f", "0x1f"),
        ("1:30", "1:30"),
        ("yes", "yes"),
        ("off", "off"),
        ("true", True),
        ("~", None),
        ("null", None),
        ("2024-01-01", "2024-01-01"),
        ('"1"', "1"),
        ("9" * 30, float("9" * 30)),
        ("<<", "<<"),
        ("=", "="),
    ],
)
def test_scalars_are_those_of_json_and_not_the_surprises_of_yaml(text, value):
    """`no` is a text, 1e-3 a number, 1:30 not ninety."""
    assert parse(f"a: {text}").data == {"a": value}


BOMB = "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n"


@pytest.mark.parametrize(
    ("text", "problem", "place"),
    [
        (BOMB, "anchors", Place(1, 4)),
        ("a: *b", "anchors", Place(1, 4)),
        ("a: !!python/object/apply:os.system [ls]", "tag", Place(1, 4)),
        ("a: !!python/name:os.system x", "tag", Place(1, 4)),
        ("a: !!binary x", "tag", Place(1, 4)),
        ("a: !!int x", "tag", Place(1, 4)),
        ("a: ! x", "tag", Place(1, 4)),
        ("a: 1\nb: 2\na: 3", "appears twice", Place(3, 1)),
        ("? [1]\n: 2", "a key is a list", Place(1, 3)),
        ("[" * 5000, "nested deeper", Place(1, 41)),
        ("a:\n" + "".join(" " * i + "- \n" for i in range(1, 60)), "nested deeper", None),
        ("a: [1, 2\nb: 3", "not valid YAML", Place(2, 2)),
        ("a: \x00", "not valid YAML", None),
        ("a: 1\n--- \nb: 2", "not valid YAML", None),
    ],
)
def test_harmful_or_ambiguous_text_is_refused_at_its_position(text, problem, place):
    """No object is built from it."""
    with pytest.raises(DocumentError, match=problem) as refusal:
        parse(text)
    if place:
        assert refusal.value.place == place


def test_a_field_is_located_in_the_text_and_a_missing_one_at_its_parent():
    """Block and flow style, and names with dots."""
    document = parse("id: p\nchannels:\n  - name: f\n    enters: {x1: phi1, x2: 3*}\n")
    assert document.place("channels[0].enters.x2") == Place(4, 28)
    assert document.place("channels[0].kind") == Place(3, 5)
    assert document.place("channels[7].kind") == Place(3, 3)
    assert document.place("nothing") == Place(1, 1)


def test_the_mark_is_below_the_error_within_an_expression():
    """Also in a quoted text, whose value begins one column later."""
    document = parse("dynamics:\n  x: 'a + b*q'\n")
    error = FieldError(field="dynamics.x", value="q", problem="unknown name", remedy="declare it")
    message, line, mark = document.located(error, offset=6, text="a + b*q").split("\n")
    assert ":2:13: dynamics.x: unknown name" in message
    assert line[mark.index("^")] == "q"


def test_files_that_are_too_large_binary_or_of_another_kind_are_refused(tmp_path):
    """Before they are parsed."""
    (tmp_path / "large.yaml").write_text("a: " + "x" * 1000)
    (tmp_path / "latin.yaml").write_bytes(b"a: \xe9")
    (tmp_path / "plant.txt").write_text("a: 1")
    for name, words in (
        ("large.yaml", "larger than 500 bytes"),
        ("latin.yaml", "UTF-8"),
        ("plant.txt", r"neither YAML nor JSON"),
        ("none.yaml", "No such file"),
    ):
        with pytest.raises(DocumentError, match=words):
            read(tmp_path / name, 500)


def test_a_byte_order_mark_and_windows_line_ends_are_accepted(tmp_path):
    """Editors write them."""
    (tmp_path / "a.yml").write_bytes("\ufeffa: 1\r\nb: é\r\n".encode())
    document = read(tmp_path / "a.yml", 500)
    assert document.data == {"a": 1, "b": "é"}
    assert document.place("b") == Place(2, 4)
