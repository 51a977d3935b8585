"""The pages of the papers: what a paper claims, its equations, its figures beside computed ones, numbers and errata."""

from typing import Annotated

from pydantic import Field

from thetascope_schemas.experiment.base import Identifier, Number, Positive, Strict, example
from thetascope_schemas.service.learning.measures import Measure
from thetascope_schemas.service.learning.questions import Words

_CLAIM = {"en": "θ̂ converges exponentially.", "zh": "θ̂ 指数收敛。"}
_MEASURE = {"kind": "level", "take": "mean", "column": "adaptive.theta.theta3", "start": 90.0, "end": 100.0}
_EQUATION = {"number": "(34d)", "tex": r"\dot{\hat\theta} = \Gamma\Omega^{\mathsf T}(y - \hat y)", "about": _CLAIM}
_FIGURE = {"number": "Fig. 2", "experiment": "zhao-2012", "figure": "parameters", "printed": _CLAIM}
_NUMBER = {
    "what": _CLAIM,
    "printed": {"en": "0.02"},
    "experiment": "zhao-2012-noise-free",
    "measure": _MEASURE,
    "expected": 0.02,
    "within": 1e-6,
}
_ERRATUM = {
    "printed": {"en": "Ψθ̃"},
    "used": {"en": "Ψθ̂"},
    "reason": {"en": "No observer knows θ̃.", "zh": "没有观测器知道 θ̃。"},
}
_CITATION = {
    "authors": {"en": "Zhao L., Li P., Li X.", "zh": "赵黎丽，李平，李修亮"},
    "title": {
        "en": "Adaptive observer design for a class of nonlinear systems",
        "zh": "一类非线性系统的自适应观测器设计",
    },
    "journal": {"en": "Control Theory & Applications 29(1), 2012", "zh": "控制理论与应用，2012，29(1)"},
}
_LINE = {"id": "zhao-2012", "citation": _CITATION, "claim": _CLAIM}
_PAPER = {
    **_LINE,
    "reading": _CLAIM,
    "equations": [_EQUATION],
    "figures": [_FIGURE],
    "numbers": [_NUMBER],
    "errata": [_ERRATUM],
    "holds": [_CLAIM],
    "fails": [_CLAIM],
}
Tex = Annotated[str, Field(min_length=1, max_length=1500, description="The formula in TeX, in the paper's notation.")]
FigureName = Annotated[str, Field(min_length=1, max_length=80, description="Name of a figure of the run.")]


class Citation(Strict):
    """Who published a paper, under which title, and where."""

    model_config = example(**_CITATION)

    authors: Words
    title: Words
    journal: Words


class PaperEquation(Strict):
    """An equation of a paper, with its number there."""

    model_config = example(**_EQUATION)

    number: str = Field(default="", max_length=20, description="Its number in the paper; empty: it has none.")
    tex: Tex
    about: Words | None = Field(default=None, description="Its purpose, or its reading here.")


class PaperFigure(Strict):
    """A figure of a paper: what is printed, and the figure of a run that is drawn beside it."""

    model_config = example(**_FIGURE)

    number: str = Field(max_length=20, description="Its number in the paper.")
    experiment: Identifier
    figure: FigureName
    printed: Words = Field(description="What the paper draws, and what its text says about it.")
    ours: Words | None = Field(default=None, description="How the computed figure agrees or differs.")


class PaperNumber(Strict):
    """A number that is measured in a run, beside the one that the paper prints."""

    model_config = example(**_NUMBER)

    what: Words
    printed: Words | None = Field(default=None, description="What the paper says; null: nothing.")
    experiment: Identifier
    measure: Measure
    unit: str = Field(default="", max_length=20)
    expected: Number | None = Field(description="The value of an independent computation; null: not computed.")
    within: Positive = Field(description="How far the measured value may be from it, in the same unit.")


class Evidence(Strict):
    """A run that shows an erratum."""

    model_config = example(experiment="zhao-2012-as-printed", figure="escape", numbers=[_NUMBER])

    experiment: Identifier
    figure: FigureName
    numbers: tuple[PaperNumber, ...] = Field(default=(), max_length=6)


class Erratum(Strict):
    """What a paper prints, what is used in its place, and why."""

    model_config = example(**_ERRATUM)

    printed: Words
    used: Words
    reason: Words
    evidence: Evidence | None = Field(default=None, description="Null: reading is enough, no run shows it.")


class Paper(Strict):
    """A paper as a page shows it. Its id is that of its experiment; variants of that add a word to the id."""

    model_config = example(**_PAPER)

    id: Identifier
    citation: Citation
    claim: Words = Field(description="The claim of the paper, in two sentences.")
    reading: Words = Field(description="How the paper is read here so that its example runs.")
    equations: tuple[PaperEquation, ...] = Field(min_length=1, max_length=30)
    figures: tuple[PaperFigure, ...] = Field(min_length=1, max_length=20)
    numbers: tuple[PaperNumber, ...] = Field(min_length=1, max_length=30)
    errata: tuple[Erratum, ...] = Field(min_length=1, max_length=30)
    holds: tuple[Words, ...] = Field(max_length=12, description="What of the claims holds.")
    fails: tuple[Words, ...] = Field(max_length=12, description="What does not hold, or holds with a restriction only.")


class PaperLine(Strict):
    """A paper in the list."""

    model_config = example(**_LINE)

    id: Identifier
    citation: Citation
    claim: Words


class PaperList(Strict):
    """The papers whose experiments the library has."""

    model_config = example(papers=[_LINE])

    papers: tuple[PaperLine, ...]


class PaperPage(Strict):
    """A paper and its equations as MathML."""

    model_config = example(paper=_PAPER, equations=["<math><mi>x</mi></math>"])

    paper: Paper
    equations: tuple[str, ...] = Field(description="MathML of each equation, in their order.")
