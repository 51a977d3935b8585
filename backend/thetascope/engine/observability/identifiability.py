"""Structural observability: which states and faults the outputs determine for some input, decided before a run.

The test is the rank of the observability matrix (observability_matrix.py) at random points, with generic values of
inputs, known signals and their derivatives. Full rank at one point means that states and faults can be determined from
the outputs near almost every point. Where the rank is lower, the null space names the undetermined ones and those with
which they are confounded.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from random import Random

from thetascope.engine.compiler import cache
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.model.events import modes
from thetascope.engine.observability.exact_rank import TOLERANCE, rank
from thetascope.engine.observability.observability_matrix import Found, Lie, Point, TooLarge
from thetascope.engine.observability.taylor import NO_VALUE, exact, precise
from thetascope.engine.observability.time_constant import pace
from thetascope.engine.programs.program_store import mathematics, plant_program
from thetascope.messages import Message

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
    def text(self) -> Message:
        """Return the finding in a sentence."""
        count = len(self.states)
        if count > _LISTED:
            states = Message("identifiability.states-counted", n=count)
        else:
            states = Message("identifiability.states-named", n=count, names=self.states)
        if not self.channels:
            return Message("identifiability.states-hidden", states=states)
        if len(self.channels) == 1:
            channel = self.channels[0]
            if self.states:
                return Message("identifiability.fault-like-states", channel=channel, states=states)
            return Message("identifiability.fault-hidden", channel=channel)
        if self.states:
            return Message("identifiability.faults-like-states", channels=self.channels, states=states)
        hidden = self.hidden == len(self.channels)
        code = "identifiability.faults-hidden" if hidden else "identifiability.faults-alike"
        return Message(code, channels=self.channels)


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
    text: Message

    @property
    def hidden(self) -> int:
        """Return the number of combinations of faults that no input makes visible."""
        return sum(g.hidden for g in self.groups)

    @property
    def confounded(self) -> Message | None:
        """Return which faults no input makes visible or separates, in sentences; None if there are none."""
        hidden = [g.text for g in self.groups if g.hidden]
        return _joined(hidden) if hidden else None

    @property
    def unidentifiable(self) -> tuple[str, ...]:
        """Return the channels whose fault cannot be isolated."""
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
        return Structure(**data | {"groups": groups, "text": Message.from_data(data["text"])})
    computed = _structure(plant, names)
    data = vars(computed) | {"groups": [vars(g) for g in computed.groups], "text": computed.text.as_data()}
    cache.write("structure", key, json.dumps(data).encode())
    return computed


def _structure(plant: Mapping, channels: tuple[str, ...]) -> Structure:
    program = plant_program(plant).program
    states = tuple(s["name"] for s, mode in zip(plant["states"], modes(plant), strict=True) if not mode)
    n, size = len(states), len(states) + len(channels)
    found, why, switches = _found(plant, program, channels)
    if why:
        rank_, state_rank = max((f.rank for f in found), default=0), max((f.states for f in found), default=0)
        return Structure(False, rank_, size, state_rank, n, (), Message("identifiability.undecided", why=why))
    best = max(found, key=lambda f: f.rank)
    with precise():
        groups = _groups(best.null, states, channels)
    if groups:
        text = _joined([g.text for g in groups])
        if switches:
            text = Message("identifiability.switching", text=text)
    else:
        counts = [Message("common.states", n=n)]
        if channels:
            counts.append(Message("identifiability.faults-counted", n=len(channels)))
        text = Message("identifiability.all", counts=counts)
    return Structure(True, best.rank, size, max(f.states for f in found), n, groups, text)


def _found(plant: Mapping, program: Program, channels: tuple[str, ...]) -> tuple[list[Found], Message | None, bool]:
    """Return the ranks at several points, why they do not decide the question (or None),
    and whether the equations switch."""
    findings = []
    with precise():
        try:
            moving = [s for s, mode in zip(program.states, modes(plant), strict=True) if not mode]
            lie = Lie(program, channels, tuple(moving))
            for draw in range(len(WIDTHS) * _DRAWS):
                try:
                    findings.append(lie.at(generic(plant, program, draw, WIDTHS[draw % len(WIDTHS)], lie.orders)))
                except NO_VALUE:
                    continue
                if findings[-1].rank == lie.columns:
                    break
        except TooLarge:
            return findings, Message("identifiability.too-large"), False
    return findings, None if findings else Message("identifiability.no-value"), lie.switches


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


def _joined(texts: list[Message]) -> Message:
    """Return sentences as one, separated by semicolons."""
    first, *rest = texts
    return Message("identifiability.joined", first=first, rest=_joined(rest)) if rest else first
