"""Structural observability: which states and faults the outputs determine for some input, decided before a run.

The test is the rank of the observability matrix (observability_matrix.py) at random points, with generic values of
inputs, known signals and their derivatives. Full rank at one point means that states and faults can be determined from
the outputs near almost every point. Where the rank is lower, the null space names the undetermined ones and those with
which they are confounded.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from decimal import Decimal
from random import Random

from thetascope.engine.compiler import cache
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.observability.exact_rank import TOLERANCE, rank
from thetascope.engine.observability.observability_matrix import Found, Lie, Point, TooLarge
from thetascope.engine.observability.taylor import NO_VALUE, exact, precise
from thetascope.engine.observers.support.time_constant import pace
from thetascope.engine.programs.program_store import mathematics, plant_program

WIDTHS = (0.5, 0.05, 0.005, 2.0, 10.0)  # of a state's scale: spread of the points around the initial state
_DRAWS = 2  # points per width
_LISTED = 5  # most states that are named individually


@dataclass(frozen=True)
class Group:
    """Faults and states that cannot be distinguished. ``hidden``: how many combinations of faults affect no output."""

    channels: tuple[str, ...]
    states: tuple[str, ...]
    hidden: int

    @property
    def text(self) -> str:
        """Return the group in words."""
        many = len(self.states) > _LISTED
        them, states = _listed(self.channels), f"{len(self.states)} of the states" if many else _listed(self.states)
        if not self.channels:
            return f"{states} cannot be told from the outputs"
        beside = (
            f" {'' if many else 'the states ' if len(self.states) > 1 else 'the state '}{states}" if self.states else ""
        )
        if len(self.channels) == 1:
            return f"{them} cannot be told from{beside}" if beside else f"{them} shows in no output"
        if self.hidden == len(self.channels) and not self.states:
            return f"{them} show in no output"
        return f"{them} cannot be told apart by any input" + (f", nor from{beside}" if beside else "")


@dataclass(frozen=True)
class Structure:
    """``rank`` of the observability matrix in (x, θ), of ``size``; ``state_rank``: in x alone, of ``states``.

    ``decided`` is False where the plant is too large or its equations have no value at the points tried.
    """

    decided: bool
    rank: int
    size: int
    state_rank: int
    states: int
    groups: tuple[Group, ...]
    text: str

    @property
    def hidden(self) -> int:
        """Return the number of combinations of faults that no input reveals."""
        return sum(g.hidden for g in self.groups)

    @property
    def confounded(self) -> str:
        """Return in words which faults no input can determine; empty if nothing is hidden."""
        return "; ".join(g.text for g in self.groups if g.hidden)

    @property
    def unidentifiable(self) -> tuple[str, ...]:
        """Return the channels whose fault cannot be determined separately."""
        return tuple(c for g in self.groups for c in g.channels)


def structure(plant: Mapping, channels: tuple[str, ...] | None = None) -> Structure:
    """Return the structural observability of a plant's data for some channels (None: all; others are fault-free)."""
    names = tuple(c["name"] for c in plant["channels"]) if channels is None else channels
    what = ["structure", mathematics(plant), names, cache.package_digest()]
    key = hashlib.sha256(json.dumps(what, sort_keys=True, separators=(",", ":")).encode()).hexdigest()
    stored = cache.read("structure", key)
    if stored is not None:
        data = json.loads(stored)
        groups = tuple(Group(tuple(g["channels"]), tuple(g["states"]), g["hidden"]) for g in data.pop("groups"))
        return Structure(**data, groups=groups)
    result = _structure(plant, names)
    cache.write("structure", key, json.dumps(asdict(result)).encode())
    return result


def _structure(plant: Mapping, channels: tuple[str, ...]) -> Structure:
    program = plant_program(plant).program
    states = tuple(s["name"] for s in plant["states"])
    n, size = len(states), len(states) + len(channels)
    found, why, switches = _found(plant, program, channels)
    if why:
        rank_, state_rank = max((f.rank for f in found), default=0), max((f.states for f in found), default=0)
        return Structure(False, rank_, size, state_rank, n, (), f"not decided: {why}")
    best = max(found, key=lambda f: f.rank)
    with precise():
        groups = _groups(best.null, states, channels)
    whole = _counted(n, "state") + (f" and {_counted(len(channels), 'fault')}" if channels else "")
    text = "; ".join(g.text for g in groups)
    if not groups:
        text = f"all can be told from the outputs in principle: {whole}"
    elif switches:
        text += " (at the points tried: the equations switch)"
    return Structure(True, best.rank, size, max(f.states for f in found), n, groups, text)


def _found(plant: Mapping, program: Program, channels: tuple[str, ...]) -> tuple[list[Found], str, bool]:
    """Return the findings at several points, why they do not decide (if so), and whether the equations switch."""
    findings = []
    with precise():
        try:
            lie = Lie(program, channels)
            for draw in range(len(WIDTHS) * _DRAWS):
                try:
                    findings.append(lie.at(generic(plant, program, draw, WIDTHS[draw % len(WIDTHS)], lie.orders)))
                except NO_VALUE:
                    continue
                if findings[-1].rank == lie.columns:
                    break
        except TooLarge:
            return findings, "the plant is too large", False
    return findings, "" if findings else "the equations have no value at the points tried", lie.switches


# ---- points ----------------------------------------------------------------------------------------------------------


def generic(plant: Mapping, program: Program, seed: int, width: float, orders: int) -> Point:
    """Return a random point near the initial state; inputs and known signals have random derivatives."""
    random = Random(seed)
    rate = exact(pace(plant))
    values = {f"p.{p['name']}": exact(p["value"]) for p in plant["parameters"]}
    for state in plant["states"]:
        values[f"x.{state['name']}"] = _near(random, state["initial"], state.get("domain"), width)
    for channel in plant["channels"]:
        values[f"theta.{channel['name']}"] = exact(channel.get("typical", 1.0)) * exact(random.uniform(-0.2, 0.2))
    values["t"] = exact(random.uniform(0.0, 1.0)) / rate
    period = plant["time"].get("period")
    values |= {} if period is None else {"period": exact(period)}
    inputs = {}
    for prefix, group in (("u", plant["inputs"]), ("signal", plant["signals"])):
        for item in group:
            course = _course(random, item, max(1.0, width), rate, orders, program.time == DISCRETE)
            inputs[f"{prefix}.{item['name']}"] = course
    return Point(values, inputs)


def _near(random: Random, middle: float, domain: tuple | None, width: float) -> Decimal:
    low, high = domain or (None, None)
    scale = abs(middle) or (1.0 if low is None or high is None else (high - low) / 4)
    a, b = middle - width * scale, middle + width * scale
    return exact(random.uniform(a if low is None else max(a, low), b if high is None else min(b, high)))


def _course(random: Random, item: Mapping, width: float, rate: Decimal, orders: int, steps: bool) -> list[Decimal]:
    """Return Taylor coefficients of a generic course (or its values at successive steps) near the default."""
    given = item.get("default", 0.0)
    default = float(given) if isinstance(given, int | float) else 0.0
    low, high = item.get("bounds") or (None, None)
    scale = width * (abs(default) or ((high - low) / 4 if low is not None and high is not None else 1.0))
    course, factor = [], Decimal(1)
    for k in range(orders):
        value = exact(scale * random.uniform(-0.5, 0.5)) * factor
        if steps or not k:
            value += exact(default)
            value = value if low is None else max(value, exact(low))
            value = value if high is None else min(value, exact(high))
        course.append(value)
        factor = Decimal(1) if steps else factor * rate / (k + 1)
    return course


# ---- groups ----------------------------------------------------------------------------------------------------------


def _groups(null: list[list[Decimal]], states: tuple[str, ...], channels: tuple[str, ...]) -> tuple[Group, ...]:
    """Return the independent parts of the null space: columns joined by a vector of its reduced form."""
    n, pieces = len(states), []
    for vector in null:
        mine = {j for j, v in enumerate(vector) if abs(v) > TOLERANCE}
        vectors = [vector]
        for other in [p for p in pieces if p[0] & mine]:
            mine |= other[0]
            vectors += other[1]
            pieces.remove(other)
        pieces.append((mine, vectors))
    groups = []
    for columns, vectors in sorted(pieces, key=lambda piece: (min(piece[0]) < n, sorted(piece[0]))):
        picked = [j for j in sorted(columns) if j >= n]
        hidden = rank([[v[j] for j in picked] for v in vectors]) if picked else 0
        among = tuple(states[j] for j in sorted(columns) if j < n)
        groups.append(Group(tuple(channels[j - n] for j in picked), among, hidden))
    return tuple(groups)


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}" if names else ""
