"""Parity equations against plain NumPy and theory, and an observer that gives residuals only, from one file."""

import sys
from importlib.util import module_from_spec, spec_from_file_location

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.stats import chi2

from tests.engine.observers.kalman_cases import run
from tests.engine.observers.test_adding_an_observer import PLANT as TWO_TANKS
from tests.engine.observers.test_matched_faults import LINEAR, SWING
from tests.live.session.test_session import advance, assert_same
from tests.simulate import simulate
from thetascope import library
from thetascope.assembly.analyses.observer_catalogue import observer_kinds
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.engine.observers import registry
from thetascope.figures import figure, figure_names
from thetascope.live.session.session import Session
from thetascope.runs.results.summary import summarise
from thetascope_schemas import Experiment

FAULTS = ("inflow", "drain", "drive")
STD, PERIOD = 0.005, 0.1
NOISE = {name: {"std": STD, "sample_time": PERIOD} for name in ("y1", "y2")}
A = np.array([[-2.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, -0.5]])
C = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
PHI = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # columns: inflow, drain, drive


def lags(faults: list[dict], gains: dict | None = None, channels: tuple[str, ...] = FAULTS, **spec) -> Result:
    spec = {"horizon": 20.0, "step": 0.01, "evaluate": PERIOD, "noise": NOISE} | spec
    return run(LINEAR, "parity", channels, gains or {}, faults=faults, **spec)


def step(channel: str, size: float = 0.2) -> dict:
    return {"channel": channel, "shape": "step", "onset": 8.0, "size": size}


def share(result: Result, channel: str) -> float:
    """Return the share of the rows after 10 s on which a residual is above its threshold."""
    return float((result.column(f"o.residual.{channel}")[100:] > 1).mean())


def test_its_residuals_are_those_of_generalised_least_squares():
    """Each square is what the best state and the best course of its own fault leave of a window of output errors."""
    result, alpha = lags([step("inflow")], {"alpha": 0.01}), 0.01
    joint = np.zeros((7, 7))
    joint[:3, :3], joint[:3, 3:6], joint[:3, 6] = A, PHI, [0.0, 1.0, 0.0]
    sampled = expm(joint * PERIOD)
    F, held, drive = sampled[:3, :3], sampled[:3, 3:6], sampled[:3, 6]
    model = np.zeros((201, 3))
    for k in range(200):
        model[k + 1] = F @ model[k] + drive
    errors = np.stack([result.column("y.y1"), result.column("y.y2")], axis=1) - model @ C.T
    length = sum(np.isnan(result.column("o.residual.inflow")))
    for j, name in enumerate(FAULTS):
        blocks = [np.vstack([C @ np.linalg.matrix_power(F, k) for k in range(length)])]
        for at in range(length - 1):
            after = [
                C @ np.linalg.matrix_power(F, k - 1 - at) @ held[:, j] if k > at else [0, 0] for k in range(length)
            ]
            blocks.append(np.concatenate(after)[:, None])
        M = np.hstack(blocks)
        limit = chi2.isf(alpha, 2 * length - np.linalg.matrix_rank(M, 1e-7))
        for row in (100, 150, 200):
            z = errors[row - length + 1 : row + 1].ravel() / STD
            left = z - M @ np.linalg.lstsq(M, z, rcond=1e-9)[0]
            assert result.column(f"o.residual.{name}")[row] == pytest.approx(np.sqrt(left @ left / limit), rel=1e-3)


def test_noise_passes_the_thresholds_as_often_as_accepted():
    """Without faults a share of α of the samples is above; windows overlap, so the share scatters."""
    result = lags([], {"alpha": 0.05}, horizon=200.0)
    for name in FAULTS:
        assert 0.02 < share(result, name) < 0.09
    assert [c.verdict for c in lags([]).observers[0].checks][1] == "holds"


@pytest.mark.parametrize("fault", [step("inflow"), SWING, step("drain")])
def test_a_fault_moves_all_residuals_but_its_own(fault):
    """Whatever the fault does over time, its own residual stays at the noise; another one is above its threshold."""
    result, own = lags([fault], {"alpha": 1e-3}), fault["channel"]
    healthy = lags([], {"alpha": 1e-3})
    column = f"o.residual.{own}"
    assert result.column(column)[50:] == pytest.approx(healthy.column(column)[50:], abs=0.05)
    assert max(share(result, name) for name in FAULTS if name != own) > 0.5


def test_it_says_which_faults_it_cannot_tell_apart():
    """A drain and an offset of the only sensor that it reaches spoil the same output: one signature."""
    result = lags([], {}, ("drain", "offset"))
    check = result.observers[0].checks[0]
    assert check.verdict == "fails" and {"drain", "offset"} & set(str(check.text).replace(":", "").split())


def test_it_is_refused_for_a_single_output():
    """With the only output projected out nothing is left, and the refusal says what is missing."""
    single = LINEAR | {"id": "one-output", "outputs": LINEAR["outputs"][:1], "channels": LINEAR["channels"][:1]}
    with pytest.raises(SpecError):
        run(single, "parity", ("inflow",), {}, horizon=5.0, step=0.01, evaluate=PERIOD, faults=[])


def test_a_window_that_leaves_no_residual_is_refused():
    """With n states and m outputs, orders up to n/(m − 1) − 1 are refused with the least that is enough."""
    with pytest.raises(SpecError) as refused:
        lags([], options={"order": 2})
    assert refused.value.field.endswith("options.order") and "3" in str(refused.value.remedy)
    result = lags([step("inflow")], options={"order": 3})
    for name in FAULTS:
        residual = result.column(f"o.residual.{name}")[10:]
        assert np.isfinite(residual).all() and residual.std() > 0


def test_it_says_where_its_model_runs_away():
    """On an unstable plant the error of the model grows without bound; an integrator is fine."""
    for drain, verdict in (("0.5*c", "fails"), ("0", "holds"), ("-0.5*c", "holds")):
        plant = LINEAR | {"id": "lags", "dynamics": LINEAR["dynamics"] | {"c": f"a - b + {drain}"}}
        spec = {"horizon": 6.0, "step": 0.01, "evaluate": PERIOD, "noise": NOISE}
        result = run(plant, "parity", ("inflow", "drain"), {}, faults=[], **spec)
        check = next(c for c in result.observers[0].checks if c.name.code == "check.beside")
        assert check.verdict == verdict
        assert verdict == "holds" or check.value == pytest.approx(0.5, rel=1e-6)


CODE = '''"""The change of each output: residuals only, neither states nor faults."""

from thetascope.engine.observers.support.declaration import Gain, Observer
from thetascope.engine.observers.support.dimensions import RATE
from thetascope.messages import Message


def write(d):
    y = d.measured()
    z = d.states("via.y", d.m, initial=y)
    r = d.let("r", y - z)
    d.set(z, d.gain("kappa") * r)
    d.outputs("r", r)


OBSERVER = Observer(
    id="change-only",
    source="",
    gains=(Gain("kappa", Message("gain.integration-rate"), 1.0, unit=RATE),),
    write=write,
    checks=lambda run: [],
    estimates_theta=False,
    residuals=True,
    chooses=lambda c: (),
    diagnostics=lambda run: {f"residual.{i}": run.values[f"r.{i}.0"] / 0.1 for i in range(run.context.m)},
)
'''
NAME = "thetascope.engine.observers.papers.change_only"


@pytest.fixture
def change_only(tmp_path, monkeypatch):
    """Register an observer that is one file, by its line in the registry."""
    file = tmp_path / "change_only.py"
    file.write_text(CODE, encoding="utf-8")
    location = spec_from_file_location(NAME, file)
    module = module_from_spec(location)
    monkeypatch.setitem(sys.modules, NAME, module)
    location.loader.exec_module(module)
    monkeypatch.setitem(registry._MODULES, "change-only", "papers.change_only")
    registry.observer.cache_clear()
    yield
    registry.observer.cache_clear()


def test_an_observer_that_gives_residuals_only_takes_its_place(change_only):
    """In a run, its summary, the comparison, a session and the catalogue: what it does not estimate is left out."""
    noise = {name: {"std": 0.01, "sample_time": 0.1} for name in ("y1", "y2")}
    observers = [{"label": "o", "kind": "change-only"}, {"label": "k", "kind": "adaptive-kalman"}]
    data = {"plant": TWO_TANKS, "horizon": 12.0, "step": 0.01, "evaluate": 0.1, "noise": noise, "observers": observers}
    bias = {"channel": "bias", "shape": "step", "size": 0.5, "onset": 8.0}
    spec = library.resolve(Experiment.model_validate(data | {"faults": [bias]}))
    result = simulate(spec)
    assert [n for n in result.names if n.startswith("o.")] == ["o.residual.0", "o.residual.1"]
    assert np.abs(result.column("o.residual.1")[81:90]).max() > 1
    summary = summarise(result, spec)
    residuals, estimates = summary.comparison.observers
    assert (residuals.rmse, residuals.steps) == ({}, ()) and "theta.bias" in estimates.rmse
    assert summary.observers[0].rmse == {} and summary.observers[0].theta == {}
    session, pieces = Session(spec), []
    advance(session, 60, pieces)
    assert_same(pieces, session)
    entry = next(kind for kind in observer_kinds() if kind["id"] == "change-only")
    assert entry["residuals"] and entry["takes_channels"] and not entry["estimates_theta"]


def test_a_session_has_the_residuals_of_its_run():
    """Bit for bit, in blocks of any length."""
    data = {
        "plant": LINEAR,
        "horizon": 12.0,
        "step": 0.01,
        "evaluate": PERIOD,
        "noise": NOISE,
        "faults": [step("drain")],
    }
    spec = library.resolve(Experiment.model_validate(data | {"observers": [{"label": "o", "kind": "parity"}]}))
    session, pieces = Session(spec), []
    for rows in (7, 33, 60):
        advance(session, rows, pieces)
    assert_same(pieces, session)


def test_its_residuals_have_a_figure_with_their_threshold():
    """One strip for each residual, in thresholds, with a line at 1; runs without such residuals have no such figure."""
    spec = library.resolve(library.experiment("dc-motor-parity"))
    result = simulate(spec)
    assert "relations" in [one["name"] for one in figure_names(spec, result.names)]
    drawn = figure(result, spec, spec.plant, "relations")
    assert sum(line["name"].endswith("parity") for line in drawn["data"]) >= 2
    assert [shape for shape in drawn["layout"]["shapes"] if shape.get("y0") == shape.get("y1") == 1.0]
    plain = library.resolve(library.experiment("zhao-2012"))
    assert "relations" not in [one["name"] for one in figure_names(plain, ["t", "y.y", "adaptive.theta.theta1"])]
