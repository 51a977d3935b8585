"""Changes of a plant's text: only what changes is touched, in YAML and JSON."""

import pytest

from tests.runs.plants.test_text_check import TEXT
from thetascope.runs.plants.text_check import check_text
from thetascope.runs.plants.text_edit import converted, edited

LEAK = {"name": "leak2", "kind": "process", "enters": {"h2": "-sqrt(h2)/A"}, "typical": 0.1}
SHAPES = {
    "block": TEXT,
    "block without indentation": TEXT.replace("\n  - ", "\n- "),
    "no channels": TEXT[: TEXT.index("channels")],
    "empty list": TEXT[: TEXT.index("channels")] + "channels: []\n",
    "json": converted(TEXT, "json"),
    "json without channels": converted(TEXT[: TEXT.index("channels")], "json"),
    "channels first": "channels: ["
    + TEXT[TEXT.index("{name: leak") :].strip()
    + "]\n"
    + TEXT[: TEXT.index("channels")],
}


@pytest.mark.parametrize("text", SHAPES.values(), ids=SHAPES)
def test_a_channel_is_added_and_the_rest_stays(text):
    """The plant has one channel more, and every line of the text is still there."""
    before = check_text(text, "en")
    changed = edited(text, {}, {"channels": [LEAK]}, {})
    after = check_text(changed.text, "en")
    assert after.errors == () and after.plant.channels[:-1] == before.plant.channels
    assert after.plant.channels[-1].name == "leak2" and after.plant.channels[-1].typical == 0.1
    assert after.plant.model_copy(update={"channels": ()}) == before.plant.model_copy(update={"channels": ()})
    assert changed.lines and all("leak2" not in line for line in text.split("\n"))


@pytest.mark.parametrize("text", [TEXT, converted(TEXT, "json")], ids=["yaml", "json"])
def test_values_are_written_where_they_are(text):
    """Numbers change in place, also one that the text leaves to its default; unknown paths change nothing."""
    values = {"parameters[0].value": 200.5, "states[1].initial": 7, "states[0].scale": 3, "states[9].initial": 1}
    after = check_text(edited(text, values, {}, {}).text, "en")
    assert after.errors == () and after.plant.parameters[0].value == 200.5
    assert [state.initial for state in after.plant.states] == [34, 7]


@pytest.mark.parametrize("text", [TEXT, converted(TEXT, "json")], ids=["yaml", "json"])
def test_a_state_comes_with_its_equation(text):
    """A lag adds a state, a parameter and an equation."""
    items = {"states": [{"name": "q_lag", "initial": 50}], "parameters": [{"name": "T_lag", "value": 5, "unit": "s"}]}
    after = check_text(edited(text, {}, items, {"q_lag": "(q - q_lag)/T_lag"}).text, "en")
    assert after.errors == () and after.plant.dynamics["q_lag"] == "(q - q_lag)/T_lag"


def test_formats_are_converted_to_the_same_plant():
    """YAML to JSON and back is the plant; a text in the format already is unchanged, comments included."""
    json = converted(TEXT, "json")
    assert (
        check_text(json, "en").plant == check_text(TEXT, "en").plant == check_text(converted(json, "yaml"), "en").plant
    )
    assert converted("# mine\n" + TEXT, "yaml") == "# mine\n" + TEXT
