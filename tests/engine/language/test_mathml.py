"""Equations as MathML: well-formed, as they were written, in the author's order."""

import re
import xml.etree.ElementTree as Tree

import pytest

from thetascope import library
from thetascope.engine.errors import ExpressionError
from thetascope.engine.language.render.mathml import expression, plant_equations
from thetascope.engine.language.render.unicode_math import notation
from thetascope.engine.observers.registry import kinds, observer

NAMES = ["x1", "x2", "u", "a", "speed", "theta_max"]


def formula_text(mathml: str) -> str:
    """Return the characters of a formula, with fractions and powers written out."""
    words = {"mfrac": "({})/({})", "msup": "{}^{}", "msub": "{}_{}", "msqrt": "√({})", "mover": "{1}({0})"}

    def read(node: Tree.Element) -> str:
        inner = [read(child) for child in node]
        if node.tag in words:
            return words[node.tag].format(*inner) if node.tag != "msqrt" else words["msqrt"].format("".join(inner))
        return (node.text or "").strip() + "".join(inner)

    return read(Tree.fromstring(f"<mrow>{mathml}</mrow>")).replace("\u2061", "")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("x2 - u*x1", "x_2−ux_1"),
        ("-x1 + x2", "−x_1+x_2"),
        ("-a*(x1 - x2)", "−a(x_1−x_2)"),
        ("x1 - (x2 - u)", "x_1−(x_2−u)"),
        ("x1 - (-x2)", "x_1+x_2"),
        ("(x1 + x2)*u/a", "((x_1+x_2)u)/(a)"),
        ("x1/a/u", "(x_1)/(au)"),
        ("-x1/a", "−(x_1)/(a)"),
        ("(-x1)^2", "(−x_1)^2"),
        ("-x1^2", "−x_1^2"),
        ("x1^0.5", "√(x_1)"),
        ("sqrt(2*a*x1)", "√(2ax_1)"),
        ("x1*2", "x_1·2"),
        ("1e-3*x1", "10^−3x_1"),
        ("2.5e-3", "2.5·10^−3"),
        ("spow(x1, a)", "⌊x_1⌉^a"),
        ("abs(x1)*exp(-a)", "|x_1|e^−a"),
        ("where(x1 < 0, -x1, x2)", "{−x_1ifx_1<0x_2otherwise"),
        ("clip(x1, 0, speed)", "sat(x_1,0,speed)"),
        ("pi*theta_max", "πθ_max"),
    ],
)
def test_a_text_is_shown_as_it_was_written(text, shown):
    """Signs, brackets, fractions, roots and cases are those of the text, in its order."""
    assert formula_text(expression(text, NAMES)) == shown


def test_a_wrong_text_is_refused_with_its_position():
    """The checks are those of running: text that could not run is not shown."""
    with pytest.raises(ExpressionError):
        expression("x1 +* x2", NAMES)


@pytest.mark.parametrize("id", library.plants())
def test_every_plant_of_the_library_has_its_equations(id):
    """One well-formed equation per state, definition and output; each channel is where it enters."""
    plant = library.plant(id).model_dump(mode="json")
    made = plant_equations(plant)
    assert [item["name"] for item in made["states"]] == [state["name"] for state in plant["states"]]
    assert len(made["definitions"]) == len(plant["definitions"]) and len(made["outputs"]) == len(plant["outputs"])
    faults, laws = 0, sum(len(c["definitions"]) + len(c["outputs"]) + len(c["states"]) for c in plant["controllers"])
    assert len(made["controllers"]) == laws
    for item in (*made["states"], *made["definitions"], *made["outputs"], *made["controllers"]):
        Tree.fromstring(item["math"])
        faults += item["math"].count('class="fault"')
    assert faults == sum(len(channel["enters"]) for channel in plant["channels"])


def test_faults_are_terms_of_the_equations_with_their_signs():
    """Φ and Ψ appear as −v/L θ in the motor's current and + φ3 θ3 in the bioreactor's output."""
    motor = plant_equations(library.plant("dc-motor").model_dump(mode="json"))
    current = re.sub(r' xmlns="[^"]*"', "", motor["states"][0]["math"])
    assert formula_text(current).endswith("−(voltage)/(L)gain loss")
    reactor = plant_equations(library.plant("zhao-contois").model_dump(mode="json"))
    assert formula_text(re.sub(r' xmlns="[^"]*"', "", reactor["outputs"][0]["math"])) == "y=x_1+φ_3θ_3"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Γ̇ = λΓ − ΓΩᵀΩΓ", "˙(Γ)=λΓ−ΓΩ^TΩΓ"),
        ("ẋ̂ = f(x̂, u)", "˙(ˆ(x))=f(ˆ(x),u)"),
        ("Δ⁻¹[k₀ + {1 / ρ}Υ]", "Δ^−1[k_0+(1)/(ρ)Υ]"),
        ("diag(ρ, √{Γ / 2})", "diag(ρ,√((Γ)/(2)))"),
    ],
)
def test_typed_mathematics_becomes_mathml(text, shown):
    """Accents (the dot over the hat), indices, exponents, fractions, roots, words."""
    assert formula_text(notation(text)) == shown


@pytest.mark.parametrize("text", ["x_1", "{1 / 2", "q\u0308", "(a"])
def test_wrong_notation_is_refused(text):
    """An error in an observer's equations is found by the tests."""
    with pytest.raises(ValueError):
        notation(text)


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_of_observer_shows_its_equations(kind):
    """At least the update of the state; all are readable, and every explained symbol is in one of them."""
    made = observer(kind)
    assert made.equations and all(Tree.fromstring(notation(text)) is not None for _, text in made.equations)
    everything = " ".join(text for _, text in made.equations)
    for sign, words in made.where:
        assert words and sign[0] in everything
