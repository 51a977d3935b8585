"""An input that would restore excitation: found by trying some on the plant without faults.

Square waves, sines, random binary sequences and steps to other levels, within the declared bounds and around what the
input is now, at periods around the plant's time constant. Each is simulated from the present state, and the filter's Ω
along it gives J, as it would be seen. The one with the largest smallest eigenvalue (in typical faults) is proposed, in
the smallest swing that is enough.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.input_design.excitation import excitation
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.engine.inputs.signals import constant, signal
from thetascope.engine.observability.identifiability import Structure, structure
from thetascope.engine.observers.support.kalman_defaults import state_scales
from thetascope.engine.observers.support.time_constant import pace
from thetascope.engine.simulation.experiment import Experiment, State
from thetascope.engine.simulation.simulation import Simulation, row_values

SWINGS = (0.25, 0.1, 0.04)  # of the input's range, to each side
WIDE = 0.5  # where that is not enough
PERIODS = (0.6, 2.0, 6.0, 20.0)  # of the plant's time constant
_LEAST_ROWS = 6  # in a period
_BUDGET = 400_000  # base steps simulated in all, about
_HELPS = 2.0  # times the level that there is now: less is no help


@dataclass(frozen=True)
class Proposal:
    """``input`` and its ``signal`` (plain data of a Signal) from now on; None where nothing that was tried helps.

    ``level``: smallest eigenvalue that it reaches (the best that was reached), ``before``: that of the present input,
    ``needed``: that for the accuracy asked; all over one window, in (typical fault/its standard deviation)².
    """

    input: str | None
    signal: dict | None
    level: float
    before: float
    needed: float
    text: str


def propose(
    filter_: InnovationFilter,
    experiment: Experiment,
    x: np.ndarray,
    k: int,
    window: float,
    accuracy: float,
    among: Sequence[str] | None = None,
) -> Proposal:
    """Look for an input for ``experiment`` (as it is now) from state ``x`` at base step ``k`` on.

    window: length in s over which faults are to be told apart; accuracy: standard deviation asked for, as a share of a
    typical fault; among: the channels that matter (None: all); the others are taken to be sound.
    """
    trial = _Trial(filter_, experiment, x, k, window, accuracy, among)
    before = trial.level(None, None)
    needed = 1.0 / accuracy**2
    if before >= needed:
        text = "the input as it is tells the faults apart as far as any does: none is proposed"
        return Proposal(None, None, before, before, needed, trial.and_structure(text))
    if not trial.inputs:
        return Proposal(None, None, before, before, needed, "the plant has no input that could excite it")
    best, level = trial.best(SWINGS[0], before)
    if level < needed:
        wider, reached = trial.best(WIDE, before)
        best, level = (wider, reached) if reached > level else (best, level)
    if best is None or level < _HELPS * before or level < 1.0:
        return Proposal(None, None, level, before, needed, trial.nothing())
    for swing in SWINGS[1:] if level >= needed else ():
        smaller = next(m for n, m in trial.candidates(swing) if n == best[0] and _alike(m, best[1]))
        reached = trial.level(best[0], smaller)
        if reached < needed:
            break
        best, level = (best[0], smaller), reached
    return Proposal(*best, level, before, needed, trial.sentence(*best, level, before, needed))


def _alike(a: Mapping, b: Mapping) -> bool:
    """The same but for the swing."""
    size = ("low", "high", "amplitude", "offset", "values")
    same = {n: v for n, v in a.items() if n not in size} == {n: v for n, v in b.items() if n not in size}
    return same and (a["kind"] != "steps" or (a["values"][1] > a["values"][0]) == (b["values"][1] > b["values"][0]))


class _Trial:
    def __init__(
        self,
        filter_: InnovationFilter,
        experiment: Experiment,
        x: np.ndarray,
        k: int,
        window: float,
        accuracy: float,
        among: Sequence[str] | None,
    ):
        self.filter, self.x, self.k, self.accuracy = filter_, np.asarray(x, dtype=float), k, accuracy
        names = [c.removeprefix("theta.") for c in filter_.channels]
        self.picked = [i for i, n in enumerate(names) if among is None or n in among]
        self.names = [names[i] for i in self.picked]
        model = filter_.context.model
        typical = {c["name"]: float(c.get("typical", 1.0)) for c in model["channels"]}
        self.typical = np.array([typical[n] for n in self.names])
        self.structure: Structure = structure(model, tuple(self.names))
        self.inputs = [u for u in model["inputs"] if f"u.{u['name']}" in experiment.signals]
        sound = {n: constant(0.0) for n in experiment.signals if n.startswith("theta.")}
        measurement = experiment.measurement
        quiet = replace(measurement, faults=(), std=(0.0,) * len(measurement.std))
        self.experiment = replace(experiment, estimators=(), measurement=quiet, signals=experiment.signals | sound)
        self.now = k * experiment.step
        tried = 4 + len(self.inputs) * (3 * len(PERIODS) + 2)
        steps = min(window / experiment.step, max(_BUDGET / tried / 2, 50 * experiment.every))
        rows = max(4, int(steps / experiment.every))
        self.half, self.factor = rows, window / (rows * filter_.interval)  # J grows with time

    def best(self, swing: float, before: float) -> tuple[tuple[str, dict] | None, float]:
        """The best candidate, the first of equals, and its level; None and ``before`` where none is better than that."""
        best, level = None, before
        for name, made in self.candidates(swing):
            reached = self.level(name, made)
            if reached > level * (1 + 1e-6):
                best, level = (name, made), reached
        return best, level

    def level(self, name: str | None, made: Mapping | None) -> float:
        """The smallest eigenvalue that can be had (apart from what no input brings to light); 0 where the plant escapes."""
        J = self.information(name, made)
        if J is None:
            return 0.0
        values = np.linalg.eigvalsh(J * np.outer(self.typical, self.typical))
        hidden = self.structure.hidden
        level = float(max(values[hidden], 0.0)) if hidden < len(values) else 0.0
        return level if level > 1e-13 * values[-1] else 0.0

    def information(self, name: str | None, made: Mapping | None) -> np.ndarray | None:
        """J over the second half of two windows: by then the outputs answer to faults that have long been there."""
        e = self.experiment
        e = e if name is None else replace(e, signals=e.signals | {f"u.{name}": signal(made)})
        count = 2 * self.half * e.every
        state = State(self.k, self.x.copy(), (), e.measurement.start())
        parts = [rows for _, rows in Simulation(e, e.substeps or 1).spans(count, state)]
        index = np.concatenate([r.index for r in parts])
        plant, y = np.concatenate([r.plant for r in parts]), np.concatenate([r.y for r in parts])
        if not self._inside(plant):
            return None
        table = self.filter.table(index, y, row_values(e, index, plant))
        first = self.filter.start()
        first[: self.filter.n] = self.x
        omega = self.filter.run(first, np.zeros(self.filter.p), table, index * e.step).omega[-self.half :]
        omega = omega.reshape(-1, self.filter.p)[:, self.picked]
        return omega.T @ omega * self.factor if np.isfinite(omega).all() else None

    def _inside(self, plant: np.ndarray) -> bool:
        """Whether the plant stays where it may be."""
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

    # ---- candidates ----------------------------------------------------------------------------------------------------

    def candidates(self, swing: float) -> Iterator[tuple[str, dict]]:
        """Names of inputs and signals for them."""
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
                        "start": self.now,
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
                yield u["name"], {"kind": "steps", "times": [self.now], "values": [present, value]}

    def _range(self, u: Mapping, swing: float) -> tuple[float, float, float, float]:
        """Lower and upper value, their middle, and the value now."""
        here = np.array([self.now])
        present = float(self.experiment.signals[f"u.{u['name']}"](here, here + 1e-4 * self.experiment.step)[0])
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
        constant_ = 1 / pace(self.filter.context.model)
        return sorted({_short(float(np.clip(p * constant_, least, max(least, most)))) for p in PERIODS})

    # ---- words ---------------------------------------------------------------------------------------------------------

    def sentence(self, name: str, made: dict, level: float, before: float, needed: float) -> str:
        unit = next((u.get("unit") or "" for u in self.inputs if u["name"] == name), "")
        text = f"{_described(name, made, unit)} would "
        reached = f"stand out {level**0.5:.3g} times above the noise instead of {before**0.5:.2g}"
        if level >= needed and len(self.names) == 1:
            text += f"show the fault: a typical one would {reached}"
        elif level >= needed:
            text += f"tell the faults apart: the least visible combination would {reached}"
        else:
            text += f"help: the least visible combination would {reached}; {needed**0.5:.3g} times are asked for"
            J = self.information(name, made)
            left = "" if J is None else excitation(J, self.names, self.typical, self.accuracy).text
            return text + (f"; still {left}" if left else "")
        return self.and_structure(text)

    def and_structure(self, text: str) -> str:
        """With what no input can tell apart."""
        return text + (f"; {self.structure.confounded}" if self.structure.hidden else "")

    def nothing(self) -> str:
        """Why none is proposed."""
        J = self.information(None, None)
        now = "" if J is None else excitation(J, self.names, self.typical, self.accuracy).text
        if self.structure.decided and self.structure.hidden:
            return f"no course of an input that was tried helps, and {self.structure.confounded}: {now}"
        listed = ", ".join(u["name"] for u in self.inputs)
        signals = [s["name"] for s in self.filter.context.model["signals"]]
        fixed = f" with the known signals ({', '.join(signals)}) as they are" if signals else ""
        return f"no course of {listed} that was tried helps{fixed}: {now}"


def _described(name: str, made: Mapping, unit: str) -> str:
    unit = f" {unit}" if unit else ""
    match made["kind"]:
        case "pulse":
            return (
                f"a square wave of {name} between {made['low']:g} and {made['high']:g}{unit} with a period of "
                f"{made['period']:g} s"
            )
        case "sine":
            return (
                f"a sine of {name} about {made['offset']:g}{unit} with amplitude {made['amplitude']:g}{unit} and "
                f"{made['frequency']:g} Hz"
            )
        case "prbs":
            return (
                f"{name} jumping at random between {made['low']:g} and {made['high']:g}{unit}, drawn anew every "
                f"{made['hold']:g} s,"
            )
    return f"a step of {name} to {made['values'][1]:g}{unit}"


def _short(value: float) -> float:
    """Three digits are enough for a proposal."""
    return float(f"{value:.3g}")
