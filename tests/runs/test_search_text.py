"""Reading the text by which runs are sought."""

import pytest

from thetascope.runs.notebook.search_text import parse_search
from thetascope.store.notebook.listing import Condition


@pytest.mark.parametrize(
    ("text", "words", "conditions"),
    [
        ("", (), ()),
        ("lab 2", ("lab", "2"), ()),
        ('"lab 2", tank', ("lab 2", "tank"), ()),
        ("λ ≥ 2 quick", ("quick",), (Condition("lambda", ">=", 2.0),)),
        ("adaptive.gains.rho=4 rmse<1e-3", (), (Condition("rho", "=", 4.0), Condition("rmse", "<", 1e-3))),
        ("false_alarms = 0", (), (Condition("alarms", "=", 0.0),)),
        ("size > −0.5", (), (Condition("size", ">", -0.5),)),
        ("lambda >", ("lambda", ">"), ()),
    ],
)
def test_words_and_conditions(text, words, conditions):
    """Phrases, Greek letters, names with dots, and signs of several forms."""
    assert parse_search(text) == (words, conditions)
