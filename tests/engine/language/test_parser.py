"""Parsing: hostile text is refused at its position, and accepted text is read."""

import math
import pickle
import subprocess
import sys

import pytest
import sympy
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Symbol

from tests.engine.language.expression_language import NAMES, SYMBOLS
from thetascope.engine.errors import ExpressionError, SpecError
from thetascope.engine.language.parser import MAX_LENGTH, MAX_TOKENS, parse


def refused(text: str, names: tuple[str, ...] = NAMES) -> ExpressionError:
    with pytest.raises(ExpressionError) as caught:
        parse(text, names, "dynamics.x").sympy({name: Symbol(name, real=True) for name in names})
    return caught.value


# ---- hostile text --------------------------------------------------------------------------------------------------

HOSTILE: list[tuple[str, int, str]] = [  # text, column of the refusal, a part of the problem or the remedy
    ("__import__('os')", 1, "unknown function"),
    ("x + __import__('os').system('ls')", 5, "unknown function"),
    ("().__class__", 2, "missing"),
    ("x.__class__", 1, "attributes"),
    ("sin(x).real", 7, "attributes"),
    ("x .real", 1, "attributes"),
    ("x[0]", 2, "indices"),
    ("lambda x: x", 1, "reserved word"),
    ("[x for x in y]", 1, "indices"),
    ("{x}", 1, "parentheses"),
    ("f'{x}'", 1, "unknown name"),
    ("'text'", 1, "quotes"),
    ("x := 1", 3, "remove"),
    ("x = 1", 3, "left side"),
    ("x == 1", 3, "inside where"),
    ("x != 1", 3, "inside where"),
    ("sin(x=1)", 6, "left side"),
    ("sin(*x)", 5, "missing"),
    ("min(**x)", 5, "missing"),
    ("x if y < 1 else z", 3, "where"),
    ("not x", 1, "comparison"),
    ("x; y", 2, "remove"),
    ("x # y", 3, "remove"),
    ("x \\\n y", 3, "remove"),
    ("x // y", 4, "missing"),
    ("x % y", 3, "remainder"),
    ("x @ y", 3, "remove"),
    ("x & y", 3, "write and"),
    ("~x", 1, "remove"),
    ("9**9**9", 4, "exponent"),
    ("x**65", 4, "beyond ±64"),
    ("x**(-65)", 5, "beyond ±64"),
    ("(x**9)**9", 9, "powers of powers"),
    ("((x**y)**8)**8", 14, "powers of powers"),
    ("10**64*10**64*10**64*10**64*10**64", 1, "no finite real value"),
    ("exp(710)", 1, "no finite real value"),
    ("1/0", 3, "division by zero"),
    ("x/0.0", 3, "division by zero"),
    ("1 + x/(2 - 2)", 8, "division by zero"),
    ("x/(0)", 4, "division by zero"),
    ("x/-0", 3, "division by zero"),
    ("x/sin(0)", 3, "division by zero"),
    ("x/(1 - 3*(1/3))", 4, "division by zero"),
    ("0**-1", 1, "division by zero"),
    ("x*0**(-2)", 3, "division by zero"),
    ("x/(y - y)", 4, "division by zero"),
    ("(y - y)**-2", 2, "division by zero"),
    ("0**x", 1, "positive base"),
    ("(-2)**x", 2, "positive base"),
    ("x + log(0)", 5, "no finite real value"),
    ("log(-1)", 1, "no finite real value"),
    ("sqrt(-1)", 1, "no finite real value"),
    ("(-8)**(1/3)", 1, "no finite real value"),
    ("asin(2)", 1, "no finite real value"),
    ("clip(x, 0, 1) + clip(1, 3, 2)", 17, "no finite real value"),
    ("x + log(y - y)", 5, "no finite real value"),
    ("sqrt(y - y - 1)", 1, "no finite real value"),
    ("exp(1e6*log(3*x))", 1, "double precision"),
    ("1j", 1, "complex"),
    ("x + 2.5J", 5, "complex"),
    ("0x10", 1, "decimal digits"),
    ("1_000", 1, "decimal digits"),
    ("1..2", 1, "decimal digits"),
    ("007", 1, "write 7"),
    ("2x", 1, "write 2*x"),
    ("2 x", 3, "write *"),
    ("x y", 3, "write *"),
    ("(x)(y)", 4, "write *"),
    ("2(x)", 2, "write *"),
    ("x(2)", 1, "write x*(…)"),
    ("9007199254740993", 1, "decimal"),
    ("1" * 1999, 1, "decimal"),
    ("1e309", 1, "too large"),
    ("1e-400", 1, "too small"),
    ("nan", 1, "unknown name"),
    ("inf", 1, "unknown name"),
    ("True", 1, "reserved word"),
    ("e", 1, "exp(1)"),
    ("pow(x, 2)", 1, "a**b"),
    ("ln(x)", 1, "log(x)"),
    ("x + x_1", 5, "did you mean x1"),
    ("sine(x)", 1, "did you mean sin"),
    ("sin", 1, "write sin(…)"),
    ("sin()", 5, "missing"),
    ("sin(x, y)", 1, "1 argument"),
    ("min(x)", 1, "at least 2"),
    ("backlash(x, y)", 1, "7 arguments"),
    ("where(x, y, z)", 7, "condition is needed"),
    ("where(x < y < z, 1, 2)", 7, "a < b and b < c"),
    ("where(not x < 1, 1, 2)", 7, "comparison"),
    ("1 + (x < y)", 6, "where(condition, 1, 0)"),
    ("x and y", 1, "where(condition, 1, 0)"),
    ("", 1, "empty"),
    (" \t\n", 1, "empty"),
    ("x +", 3, "missing"),
    ("* x", 1, "missing"),
    ("(x", 1, "never closed"),
    ("x)", 2, "closes nothing"),
    ("()", 2, "missing"),
    ("x, y", 2, "comma"),
    ("min((x, y), z)", 5, "list"),
    ("x\0", 2, "null"),
    ("x\u2212y", 2, "write -"),
    ("x\u00b2", 2, "^2"),
    ("\u0435 + 1", 1, "cyrillic"),
    ("t*\u0443", 3, "write y"),
    ("\u0445 + 1", 1, "write x"),
    ("\u03b8", 1, "unknown name"),
    ("X1", 1, "did you mean x1"),
    ("x\u00b7y", 2, "write *"),
    ("x\u202e", 2, "neither a letter"),
    ("x\u200b", 2, "neither a letter"),
    ("x\ufe0f", 2, "neither a letter"),
    ("\ud800", 1, "neither a letter"),
    ("lambda + x", 1, "use lam"),
    ("interp(x, 2)", 11, "second argument"),
    ("interp(x, y)", 11, "declare a table"),
    ("interp(x)", 1, "2 arguments"),
    ("x + 'a' + " + "x" * 10_000, 2001, "too long"),
    ("(" * 1500, 61, "deeper than 60"),
    ("-" * 1500 + "x", 61, "signs in a row"),
    ("sin(" * 400, 241 + 3, "deeper than 60"),
    ("x" + "+x" * 900, MAX_TOKENS + 1, "more than 600"),
    ("x" + "**x" * 200, 183 - 2, "deeper than 60"),
]


@pytest.mark.parametrize(("text", "column", "says"), HOSTILE, ids=[repr(case[0])[:30] for case in HOSTILE])
def test_hostile_text_is_refused_at_its_position(text: str, column: int, says: str) -> None:
    """The error names the field and the column, with a suitable problem and remedy."""
    error = refused(text)
    assert error.field == "dynamics.x"
    assert error.column == column
    assert f"column {column}" in str(error.problem)
    assert says in f"{error.problem}; {error.remedy}"
    assert len(f"{error.problem}{error.remedy}") < 400


def test_the_pointer_is_below_the_position() -> None:
    """The message shows the text with carets below it, also in the middle of a long text."""
    lines = str(refused("x + foo*y")).splitlines()
    assert lines[1:] == ["    x + foo*y", "        ^^^"]
    error = refused("x + " * 80 + "foo" + " + x" * 80)
    text, carets = error.pointer.splitlines()
    place = carets.index("^")
    assert text[place : place + 3] == "foo"
    assert carets.strip() == "^^^"
    assert len(text) < 80


def test_columns_are_those_of_the_text_as_written() -> None:
    """The power sign ^, tabs and line ends before a position do not shift it."""
    assert refused("x^2^2 +\n\ty^99").column == len("x^2^2 +\n\ty^") + 1


def test_errors_survive_pickling() -> None:
    """An expression error keeps all its parts."""
    error = refused("x + foo")
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.start, again.end, again.value) == (str(error), 4, 7, "foo")
    assert isinstance(again, SpecError)


@pytest.mark.parametrize("text", [None, 1, b"x", ["x"]])
def test_only_text_is_read(text: object) -> None:
    """A value that is not text is refused, not converted."""
    with pytest.raises(SpecError, match="text"):
        parse(text, NAMES)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "text",
    [
        "(3*x)**(y + 1000000000)*(3*x)**(-y)",
        "exp(1000000000*log(3*x))",
        "exp(y + 1000000000*log(3*x))*exp(-y)",
        "(1 + 1/9007199254740881)**64*x",
        "*".join(["(9007199254740881*x)**64"] * 70),
        "x*" + "*".join(["9007199254740881"] * 110),
        "(3*x)**(" + "*".join(["((y + y)/y)"] * 40) + ")",
        "2**(y + 1000000000)*2**(-y)",
        "exp(log(" * 29 + "x" + "))" * 29,
    ],
)
def test_no_text_causes_huge_integers(text: str) -> None:
    """SymPy expands integer powers of any size; no accepted text leads to one."""
    try:
        result = parse(text, NAMES).sympy(SYMBOLS)
    except ExpressionError:
        return
    for number in result.atoms(sympy.Number):
        assert math.isfinite(float(number))


def test_degrees_of_definitions_add_up() -> None:
    """Powers of powers are bounded across definitions, too."""
    first = parse("(3*x)**8", NAMES)
    second = parse("d**8", ("d",), degrees={"d": first.degree})
    assert (first.degree, second.degree) == (8, 64)
    with pytest.raises(ExpressionError, match="powers of powers"):
        parse("d**2", ("d",), degrees={"d": second.degree})


alphabets = [
    "xyzt019.eE+-*/^()<>=, \t\n",
    "_'\"[]{}:;.#\\@%!&|~$?`\0",
    "andornotifelselambdawhereminsincospi()<,",
    "²−×θе\u202e\u200b\uff58𝒙\ud800éπ",
]
pieces = ["x", "y", "2.5", "1e9", "9007199254740991", "pi", "+", "-", "*", "/", "**", "^", "(", ")", ",", "<", ">="]
pieces += ["sin(", "where(", "min(", "log(", " and ", " or ", "(x-x)", "x<1,", "__", "0", "1j", "."]
hostile_text = (
    st.text(max_size=80)
    | st.text(st.sampled_from("".join(alphabets)), max_size=200)
    | st.lists(st.sampled_from(pieces), max_size=60).map("".join)
    | st.tuples(st.sampled_from([*pieces, *"".join(alphabets)]), st.integers(1, 3000)).map(lambda p: p[0] * p[1])
)


@settings(max_examples=300)
@given(hostile_text)
@example("x" * 5000)
@example("((((" * 600)
def test_only_expression_errors_escape(text: str) -> None:
    """Any text is accepted or refused with a position inside it; no other exception is raised."""
    try:
        parse(text, NAMES).sympy(SYMBOLS)
    except ExpressionError as error:
        assert 0 <= error.start <= len(text)
        assert error.start < error.end <= max(len(text), error.start + 1)
        assert "^" in error.pointer
        assert error.remedy
        assert error.field == "expression"


@given(st.text(st.characters(min_codepoint=128), min_size=1, max_size=5), st.integers(0, 5))
def test_no_character_beyond_ascii_is_accepted(foreign: str, before: int) -> None:
    """Look-alikes, full-width digits and invisible characters are refused at their positions."""
    assert refused("x + y"[:before] + foreign).start <= before


def test_reading_needs_no_sympy() -> None:
    """A text is checked in a new process without loading SymPy."""
    code = "import sys, thetascope.engine.language.parser as e; e.parse('sin(x)', ['x']); print('sympy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_limits_are_exact() -> None:
    """A text of the maximum length, and one with the maximum number of operands, are accepted."""
    assert parse("x".ljust(MAX_LENGTH), NAMES).names == ("x",)
    assert parse("-x" + "+x" * (MAX_TOKENS // 2 - 1), NAMES).sympy(SYMBOLS) == (MAX_TOKENS // 2 - 2) * SYMBOLS["x"]
    assert parse("(" * 60 + "x" + ")" * 60, NAMES).sympy(SYMBOLS) == SYMBOLS["x"]
