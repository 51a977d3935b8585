"""Figures of a run: contents, colours, and cost."""

import json
import subprocess
import sys

import numpy as np
import pytest

from tests.figures.test_thin import decoded
from thetascope.figures import UnknownFigure, figure, figure_names, style

GENERAL = ["faults", "states", "outputs", "residuals", "errors", "inputs", "excitation"]
PANELS = [
    {"title": "growth", "traces": [{"column": "x.x1"}, {"column": "adaptive.x.x1"}]},
    {"log": True, "traces": [{"column": "x.x1", "minus": "slow.x.x1", "absolute": True}]},
]
LOOP = {"name": "loop", "panels": [{"x": "x.x1", "traces": [{"column": "x.x2"}, {"column": "adaptive.x.x2"}]}]}


@pytest.fixture
def run(experiment, result):
    spec = experiment(figures=[{"name": "fig-2", "title": "Figure 2", "panels": PANELS}, LOOP])
    return result(spec), spec


def named(drawn: dict, start: str) -> list[dict]:
    return [trace for trace in drawn["data"] if trace["name"].startswith(start)]


def test_own_figures_come_first_then_the_general_ones(run):
    """A run has the experiment's own figures, then the general ones."""
    outcome, spec = run
    assert [entry["name"] for entry in figure_names(spec, outcome.names)] == ["fig-2", "loop", *GENERAL]


def test_only_figures_with_data_are_offered(experiment, result):
    """Without observers there are no residuals, errors or excitation."""
    spec = experiment(observers=[])
    assert [entry["name"] for entry in figure_names(spec, result(spec).names)] == [
        "faults",
        "states",
        "outputs",
        "inputs",
    ]


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_plotly_accepts_every_figure(run, plant, theme):
    """plotly.py's validation accepts every property of every figure, and all of it is plain JSON."""
    from plotly.graph_objects import Figure

    outcome, spec = run
    for entry in figure_names(spec, outcome.names):
        drawn = figure(outcome, spec, plant, entry["name"], theme)
        json.dumps(drawn, allow_nan=False)
        Figure(drawn)


def test_curves_are_samples_of_the_run(run, plant):
    """Every drawn point of θ̂ is a row of the run."""
    outcome, spec = run
    trace = figure(outcome, spec, plant, "faults")["data"][0]
    x, y = decoded(trace["x"]), decoded(trace["y"])
    column = outcome.column("slow.theta.theta1")
    rows = np.rint(x * 100).astype(int)
    np.testing.assert_allclose(y, column[rows], rtol=1e-6, atol=1e-12)
    assert x.size <= 4004


def test_colour_means_observer(run, plant):
    """An observer has its own colour in every figure; the truth is dashed ink."""
    outcome, spec = run
    theme = style.THEMES["light"]
    for name in ("fig-2", "faults", "states", "outputs", "errors"):
        drawn = figure(outcome, spec, plant, name)
        for place, label in enumerate(("adaptive", "slow")):
            assert {trace["line"]["color"] for trace in named(drawn, label)} <= {theme.observers[place]}
        for trace in named(drawn, "truth"):
            assert trace["line"]["color"] == theme.ink and trace["line"]["dash"] != "solid"
    assert named(figure(outcome, spec, plant, "fig-2"), "slow")[0]["line"]["color"] == theme.observers[1]


def test_amber_marks_an_active_fault(experiment, result, plant):
    """The strip of a channel is tinted from onset to end; a measurement fault tints its output."""
    spec = experiment(
        faults=[
            {"channel": "theta1", "shape": "step", "onset": 40, "end": 60, "size": 0.01},
            {"output": "y", "shape": "stuck", "onset": 80, "value": 0},
        ]
    )
    outcome = result(spec)

    def tinted(name):
        return [
            (s["x0"], s["x1"], s["yref"])
            for s in figure(outcome, spec, plant, name)["layout"]["shapes"]
            if s["type"] == "rect"
        ]

    assert tinted("faults") == [(40, 60, "y domain")]
    assert tinted("outputs") == [(80, 100, "y domain")]


def test_each_name_is_in_the_legend_once(run, plant):
    """However many strips, the legend names truth and observers once."""
    outcome, spec = run
    shown = [trace["name"] for trace in figure(outcome, spec, plant, "states")["data"] if trace["showlegend"]]
    assert sorted(shown) == ["adaptive", "slow", "truth"]


def test_units_come_from_the_plant(run, plant):
    """Each strip has the unit that the plant declares."""
    outcome, spec = run
    text = " ".join(a["text"] for a in figure(outcome, spec, plant, "states")["layout"]["annotations"])
    assert "1/h2" in text and "specific" in text


def test_rare_peaks_do_not_flatten_a_strip(run, plant):
    """The range of an axis follows the truth and most of the estimates, not a single peak."""
    outcome, spec = run
    outcome.data[outcome.names.index("adaptive.theta.theta1"), 500:510] = 1e3
    low, high = figure(outcome, spec, plant, "faults")["layout"]["yaxis"]["range"]
    assert -0.02 < low < 0 and 0.01 < high < 0.03


def test_divergence_is_shown_and_does_not_set_the_scale(experiment, result, plant):
    """A diverged observer has the time in the legend, a dash as its last value, and does not affect the axis."""
    spec = experiment()
    outcome = result(spec, lost={"slow": 50.0})
    outcome.data[outcome.names.index("slow.x.x1"), 4000:5000] = 1e9
    drawn = figure(outcome, spec, plant, "states")
    assert named(drawn, "slow")[0]["name"] == "slow (diverged at 50 s)"
    assert drawn["layout"]["yaxis"]["range"][1] < 1
    assert "—" in [a["text"] for a in drawn["layout"]["annotations"]]


def test_notes_are_flags_on_the_time_axis(experiment, result, plant):
    """A line through every strip, one flag above them, and the note as text, not markup; none without a time axis."""
    notes = [{"id": "a", "t": 45.3, "text": "it <b>overshoots</b> here"}, {"id": "b", "t": 60}]
    spec = experiment(notes=notes, figures=[LOOP])
    outcome = result(spec)
    layout = figure(outcome, spec, plant, "states")["layout"]
    lines = [shape for shape in layout["shapes"] if shape["type"] == "line" and shape["x0"] == shape["x1"] == 45.3]
    assert len(lines) == 2
    flags = {note["x"]: note["hovertext"] for note in layout["annotations"] if note.get("name") == "flag"}
    assert flags == {45.3: "it &lt;b&gt;overshoots&lt;/b&gt; here", 60: "60 s"}
    loop = figure(outcome, spec, plant, "loop")["layout"]
    assert not [note for note in loop["annotations"] if note.get("name") == "flag"]


def test_unknown_names_are_refused_with_the_known_ones(run, plant):
    """For a figure or theme that does not exist."""
    outcome, spec = run
    with pytest.raises(UnknownFigure, match="fig-2, loop, faults"):
        figure(outcome, spec, plant, "nope")
    with pytest.raises(ValueError, match="light, dark"):
        figure(outcome, spec, plant, "faults", "sepia")


def test_panels_with_their_own_abscissa_have_their_own_axis(experiment, result, plant):
    """A loop beside a panel over time: two horizontal axes, the loop's with its quantity and unit."""
    spec = experiment(figures=[{"name": "both", "panels": [LOOP["panels"][0], PANELS[0]]}])
    layout = figure(result(spec), spec, plant, "both")["layout"]
    assert layout["xaxis"]["title"]["text"] == "<i>x</i><sub>1</sub> (1/h)"
    assert layout["xaxis2"]["title"]["text"] == "time (s)"


def test_plotly_is_not_imported():
    """Figures are made without importing plotly."""
    code = "import sys, thetascope.figures; print([m for m in sys.modules if m.split('.')[0] in ('plotly', 'sympy')])"
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"
    )


def test_figures_are_in_the_requested_language(experiment, result, plant):
    """Titles, captions, legends and the time axis of every general figure are Chinese; symbols are unchanged."""
    spec = experiment(observers=[{"label": label, "kind": "zhao-adaptive"} for label in ("adaptive", "slow")])
    outcome = result(spec, lost={"slow": 50.0})
    names = figure_names(spec, outcome.names, "zh")
    assert len(names) >= 6 and all("\u4e00" <= entry["title"][0] <= "\u9fff" for entry in names)
    for entry in names:
        drawn = figure(outcome, spec, plant, entry["name"], language="zh")
        assert drawn["layout"]["meta"]["title"] == entry["title"]
        shown = json.dumps(drawn["layout"]["meta"], ensure_ascii=False)
        shown += json.dumps([trace.get("name", "") for trace in drawn["data"]], ensure_ascii=False)
        assert not any(word in shown for word in ("truth", "measured", "diverged", "fault", "state", "Output"))
