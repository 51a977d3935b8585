"""An input that restores excitation, found by trying some on the plant without faults.

Square waves, sines, random binary sequences and steps to other levels are tried, within the declared bounds and around
the present value of the input, at periods around the plant's time constant. Each is simulated from the present state,
and the filter's Ω along it gives J as it would be observed. The one with the largest smallest eigenvalue (in typical
faults) is proposed, at the smallest swing that suffices.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.input_design.excitation import excitation
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.diagnosis.sentences import joined
from thetascope.engine.inputs.signals import constant, signal
from thetascope.engine.observability.identifiability import Structure, structure
from thetascope.engine.observers.support.kalman_defaults import pace, state_scales
from thetascope.engine.simulation.controlled import simulation_of
from thetascope.engine.simulation.experiment import Experiment, State
from thetascope.engine.simulation.loop import LoopRows
from thetascope.engine.simulation.simulation import row_values
from thetascope.messages import Message

SWINGS = (0.25, 0.1, 0.04)  # to each side, as shares of the input's range
WIDE = 0.5  # the swing that is tried where these do not suffice
PERIODS = (0.6, 2.0, 6.0, 20.0)  # in time constants of the plant
_LEAST_ROWS = 6  # in a period
_BUDGET = 400_000  # base steps of all simulations, about
_HELPS = 2.0  # factor by which an input has to raise the level


@dataclass(frozen=True)
class Proposal:
    """A proposed input.

    Attributes:
        input, signal: the input and its course from now on (plain data of a Signal); None if nothing that was tried
            helps.
        level: smallest eigenvalue that it reaches, over one window, in (typical fault / its standard deviation)².
        before: the same for the present input.
        needed: the level that the required accuracy needs.
        text: the proposal, or the reason why no input is proposed.
    """

    input: str | None
    signal: dict | None
    level: float
    before: float
    needed: float
    text: Message


def propose(
    filter_: InnovationFilter,
    experiment: Experiment,
    x: np.ndarray,
    k: int,
    window: float,
    accuracy: float,
    among: Sequence[str] | None = None,
    loop: np.ndarray | None = None,
) -> Proposal:
    """Return an input that separates the faults; in a closed loop a reference or an input that no controller sets.

    Args:
        filter_: the detector's filter.
        experiment: the experiment as it is now; of a true plant, its model.
        x: (n,), the present state of the plant.
        k: the present base step.
        window: time within which faults have to be separated, s.
        accuracy: required standard deviation, as a share of a typical fault.
        among: the channels to be separated, the others being healthy; None: all.
        loop: the present state of the controllers (`State.loop`).
    """
    experiment = experiment.modelled
    x = x[: len(experiment.plant.states)]
    trial = _Trial(filter_, experiment, x, k, window, accuracy, among, loop)
    before = trial.level(None, None)
    needed = 1.0 / accuracy**2
    if before >= needed:
        text = trial.with_structure([Message("diagnosis.proposal.not-needed")])
        return Proposal(None, None, before, before, needed, text)
    if not trial.inputs:
        return Proposal(None, None, before, before, needed, Message("diagnosis.proposal.no-input"))
    best, level = trial.best(SWINGS[0], before)
    if level < needed:
        wider, reached = trial.best(WIDE, before)
        best, level = (wider, reached) if reached > level else (best, level)
    if best is None or level < _HELPS * before or level < 1.0:
        return Proposal(None, None, level, before, needed, trial.no_proposal())
    for swing in SWINGS[1:] if level >= needed else ():
        smaller = next(m for n, m in trial.candidates(swing) if n == best[0] and _alike(m, best[1]))
        reached = trial.level(best[0], smaller)
        if reached < needed:
            break
        best, level = (best[0], smaller), reached
    return Proposal(*best, level, before, needed, trial.text(*best, level, before, needed))


def _alike(a: Mapping, b: Mapping) -> bool:
    """Return whether two signals differ in their swing only."""
    size = ("low", "high", "amplitude", "offset", "values")
    equal = {n: v for n, v in a.items() if n not in size} == {n: v for n, v in b.items() if n not in size}
    return equal and (a["kind"] != "steps" or (a["values"][1] > a["values"][0]) == (b["values"][1] > b["values"][0]))


class _Trial:
    """Simulations of one plant under other inputs, from its present state."""

    def __init__(
        self,
        filter_: InnovationFilter,
        experiment: Experiment,
        x: np.ndarray,
        k: int,
        window: float,
        accuracy: float,
        among: Sequence[str] | None,
        loop: np.ndarray | None,
    ):
        self.filter, self.x, self.k, self.accuracy = filter_, np.asarray(x, dtype=float), k, accuracy
        self.loop = loop
        names = [c.removeprefix("theta.") for c in filter_.channels]
        self.chosen = [i for i, n in enumerate(names) if among is None or n in among]
        self.names = [names[i] for i in self.chosen]
        model = filter_.context.model
        typical = {c["name"]: float(c.get("typical", 1.0)) for c in model["channels"]}
        self.typical = np.array([typical[n] for n in self.names])
        self.structure: Structure = structure(model, tuple(self.names))
        groups = (("u", model["inputs"]), ("r", model.get("references", ())))
        items = {f"{prefix}.{item['name']}": item for prefix, group in groups for item in group}
        self.inputs = [item for name, item in items.items() if name in experiment.signals]
        self.columns = {item["name"]: name for name, item in items.items()}
        healthy = {n: constant(0.0) for n in experiment.signals if n.startswith("theta.")}
        measurement = experiment.measurement
        quiet = replace(measurement, faults=(), std=(0.0,) * len(measurement.std))
        self.experiment = replace(experiment, estimators=(), measurement=quiet, signals=experiment.signals | healthy)
        self.t = k * experiment.step
        trials = 4 + len(self.inputs) * (3 * len(PERIODS) + 2)
        steps = min(window / experiment.step, max(_BUDGET / trials / 2, 50 * experiment.every))
        rows = max(4, int(steps / experiment.every))
        self.half, self.factor = rows, window / (rows * filter_.interval)  # J grows with time

    def best(self, swing: float, before: float) -> tuple[tuple[str, dict] | None, float]:
        """Return (candidate, level) of the best candidate, the first of equals; (None, `before`) if none is better."""
        best, level = None, before
        for name, course in self.candidates(swing):
            reached = self.level(name, course)
            if reached > level * (1 + 1e-6):
                best, level = (name, course), reached
        return best, level

    def level(self, name: str | None, course: Mapping | None) -> float:
        """Return the smallest eigenvalue, apart from combinations that no input shows; 0 if the plant leaves its
        domain."""
        J = self.information(name, course)
        if J is None:
            return 0.0
        values = np.linalg.eigvalsh(J * np.outer(self.typical, self.typical))
        hidden = self.structure.hidden
        level = float(max(values[hidden], 0.0)) if hidden < len(values) else 0.0
        return level if level > 1e-13 * values[-1] else 0.0

    def information(self, name: str | None, course: Mapping | None) -> np.ndarray | None:
        """Return J (p, p) over the second of two windows, when the response to faults has settled; None if the plant
        leaves its domain."""
        e = self.experiment
        if name is not None and course is not None:
            e = replace(e, signals=e.signals | {self.columns[name]: signal(course)})
        count = 2 * self.half * e.every
        past = None if e.loop is None else np.empty((0, len(e.applied)))
        state = State(self.k, self.x.copy(), (), e.measurement.start(), self.loop, past)
        parts = [rows for _, rows in simulation_of(e).spans(count, state)]
        loops = [r.loop for r in parts if r.loop is not None]
        index = np.concatenate([r.index for r in parts])
        plant, y = np.concatenate([r.plant for r in parts]), np.concatenate([r.y for r in parts])
        if not self._inside(plant):
            return None
        values = row_values(e, index, plant, LoopRows.concatenated(loops) if loops else None)
        table = self.filter.table(index, y, values, e.signals)
        first = self.filter.start()
        first[: self.filter.n] = self.x
        omega = self.filter.run(first, np.zeros(self.filter.p), table, index * e.step).omega[-self.half :]
        omega = omega.reshape(-1, self.filter.p)[:, self.chosen]
        return omega.T @ omega * self.factor if np.isfinite(omega).all() else None

    def _inside(self, plant: np.ndarray) -> bool:
        """Return whether the plant's states (rows, n) are finite and stay in their domains."""
        if not np.isfinite(plant).all():
            return False
        context = self.filter.context
        for i, (state, scale) in enumerate(zip(context.model["states"], state_scales(context), strict=True)):
            low, high = state.get("domain") or (None, None)
            slack = 1e-6 * scale
            if (low is not None and plant[:, i].min() < min(low, self.x[i]) - slack) or (
                high is not None and plant[:, i].max() > max(high, self.x[i]) + slack
            ):
                return False
        return True

    # ---- candidates --------------------------------------------------------------------------------------------------

    def candidates(self, swing: float) -> Iterator[tuple[str, dict]]:
        """Yield (input, signal) of all candidates with a swing."""
        for u in self.inputs:
            low, high, middle, present = self._range(u, swing)
            for period in self._periods():
                yield (
                    u["name"],
                    {
                        "kind": "pulse",
                        "low": low,
                        "high": high,
                        "period": period,
                        "width": _short(period / 2),
                        "start": self.t,
                    },
                )
                yield (
                    u["name"],
                    {
                        "kind": "sine",
                        "amplitude": _short((high - low) / 2),
                        "frequency": _short(1 / period),
                        "phase": 0.0,
                        "offset": middle,
                    },
                )
                yield u["name"], {"kind": "prbs", "low": low, "high": high, "hold": _short(period / 2), "seed": 1}
            for value in (high, low):
                yield u["name"], {"kind": "steps", "times": [self.t], "values": [present, value]}

    def _range(self, u: Mapping, swing: float) -> tuple[float, float, float, float]:
        """Return (lower value, upper value, their middle, present value) of an input."""
        time = np.array([self.t])
        present = float(self.experiment.signals[self.columns[u["name"]]](time, time + 1e-4 * self.experiment.step)[0])
        low, high = u.get("bounds") or (None, None)
        reach = 2 * max(abs(present), abs(float(u.get("default", 0.0))), 1e-300) or 1.0
        if abs(present) < 1e-300 and not u.get("default"):
            reach = 1.0
        low, high = present - reach if low is None else low, present + reach if high is None else high
        half = swing * (high - low)
        middle = _short(float(np.clip(present, low + half, high - half)))
        return max(_short(middle - half), low), min(_short(middle + half), high), middle, present

    def _periods(self) -> list[float]:
        least, most = _LEAST_ROWS * self.filter.interval, self.half * self.filter.interval
        constant_ = 1 / pace(self.filter.context)
        return sorted({_short(float(np.clip(p * constant_, least, max(least, most)))) for p in PERIODS})

    # ---- sentences ---------------------------------------------------------------------------------------------------

    def text(self, name: str, course: dict, level: float, before: float, needed: float) -> Message:
        """Return a proposal in a sentence."""
        unit = next((u.get("unit") or "" for u in self.inputs if u["name"] == name), "")
        values = {"input": _course_text(name, course, unit), "level": level**0.5, "before": before**0.5}
        if level >= needed:
            one = len(self.names) == 1
            return self.with_structure(
                [Message("diagnosis.proposal.shows" if one else "diagnosis.proposal.separates", **values)]
            )
        texts = [Message("diagnosis.proposal.helps", required=needed**0.5, **values)]
        J = self.information(name, course)
        if J is not None:
            texts.append(Message("diagnosis.proposal.still", rest=self._excitation(J)))
        return joined(texts)

    def _excitation(self, J: np.ndarray) -> Message:
        return excitation(J, self.names, self.typical, self.accuracy).text

    def with_structure(self, texts: list[Message]) -> Message:
        """Return sentences, followed by the faults that no input separates."""
        if self.structure.hidden:
            texts = [*texts, Message("diagnosis.proposal.confounded", confounded=self.structure.confounded)]
        return joined(texts)

    def no_proposal(self) -> Message:
        """Return why no input is proposed."""
        J = self.information(None, None)
        present = Message("diagnosis.excitation.unknown") if J is None else self._excitation(J)
        if self.structure.decided and self.structure.hidden:
            confounded = self.structure.confounded
            return Message("diagnosis.proposal.none-confounded", confounded=confounded, present=present)
        inputs = [u["name"] for u in self.inputs]
        signals = [s["name"] for s in self.filter.context.model["signals"]]
        if signals:
            return Message("diagnosis.proposal.none-signals", inputs=inputs, signals=signals, present=present)
        return Message("diagnosis.proposal.none", inputs=inputs, present=present)


def _course_text(name: str, course: Mapping, unit: str) -> Message:
    """Return the course of an input in words; the numbers that it needs are arguments."""
    values = {"input": name, "unit": f" {unit}" if unit else ""}
    match course["kind"]:
        case "pulse":
            values |= {n: course[n] for n in ("low", "high", "period")}
        case "sine":
            values |= {n: course[n] for n in ("offset", "amplitude", "frequency")}
        case "prbs":
            values |= {n: course[n] for n in ("low", "high", "hold")}
        case _:
            values |= {"value": course["values"][1]}
    return Message(f"diagnosis.input.{course['kind']}", **values)


def _short(value: float) -> float:
    """Return a value rounded to three digits."""
    return float(f"{value:.3g}")
