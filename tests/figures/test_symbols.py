"""Names become mathematical symbols, and no text of a user becomes markup."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.figures.html_symbols import HAT, escape, expression, mathematical, symbol, wrap


@pytest.mark.parametrize(
    ("name", "html"),
    [
        ("theta1", "<i>θ</i><sub>1</sub>"),
        ("x21", "<i>x</i><sub>21</sub>"),
        ("theta", "<i>θ</i>"),
        ("level", "<i>level</i>"),
        ("h_max", "<i>h</i><sub>max</sub>"),
        ("phi_2", "<i>φ</i><sub>2</sub>"),
        ("Tm2", "<i>Tm2</i>"),
        ("gain_loss", "<i>gain loss</i>"),
    ],
)
def test_names_become_symbols(name, html):
    """Greek names and indices are typeset as in a paper; words are unchanged."""
    assert symbol(name) == html


def test_the_hat_is_above_the_letter():
    """An estimate's accent is on the letter, not on the index."""
    assert symbol("theta1", HAT) == "<i>θ\u0302</i><sub>1</sub>"


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("x2 - u*x1", "<i>x</i><sub>2</sub> − <i>u</i>\u2009<i>x</i><sub>1</sub>"),
        ("-2*x**2", "−2\u2009<i>x</i><sup>2</sup>"),
        ("sin(t)", "sin(<i>t</i>)"),
        ("w^2/a", "<i>w</i><sup>2</sup>/<i>a</i>"),
        ("2*3", "2\u2009·\u20093"),
        ("load*u", "<i>load</i>\u2009·\u2009<i>u</i>"),
        ("1e-3*u", "1e-3\u2009<i>u</i>"),
        ("min(a,-b)", "min(<i>a</i>, −<i>b</i>)"),
    ],
)
def test_expressions_are_typeset_like_a_paper(text, html):
    """Products are close, powers are raised, signs are spaced as binary or unary."""
    assert expression(text) == html


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("x̂1 − x1", "<i>x̂</i><sub>1</sub> − <i>x</i><sub>1</sub>"),
        ("error of theta1", "error of <i>θ</i><sub>1</sub>"),
        ("|θ3|", "|<i>θ</i><sub>3</sub>|"),
        ("level3 in cm", "level3 in cm"),
        ("&lt;b1&gt;", "&lt;b1&gt;"),
        ("betas", "betas"),
    ],
)
def test_titles_contain_typeset_symbols(text, html):
    """In titles of axes and traces, names with an index and Greek names are symbols;
    words and entities are unchanged."""
    assert mathematical(text) == html


@given(st.text(max_size=60))
def test_only_known_tags_are_written(text):
    """For any text the only tags are i, sub, sup and br, without attributes."""
    for html in (symbol(text), expression(text), wrap(text), mathematical(escape(text))):
        assert not re.search(r"<(?!/?(i|sub|sup|br)>)", html)


def test_long_captions_are_cut():
    """A caption has a maximum number of lines."""
    assert wrap("one two three four five six seven eight nine ten", 9, 3).count("<br>") == 2
