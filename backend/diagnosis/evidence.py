"""The filter of engine/innovations.py run along rows, once or under many assumptions at once, and the backward pass of
engine/onsets.py: what goes in, and what is kept."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from backend.engine.graph import variables
from backend.engine.innovations import innovations
from backend.engine.kernel import NEVER, Layout, Segments, kernel
from backend.engine.observers.base import Context
from backend.engine.observers.weights import DOUBT, process_noise, state_scales
from backend.engine.onsets import SYMMETRIC, forms, onsets, parts
from backend.engine.simulation import Experiment as Engine
from backend.engine.spread import holds, noise_stds
from backend.engine.suppositions import COURSE, sums, suppositions

MOST_STATES = 12
WIDTH = 8  # assumptions in one pass: as many as a vector of the processor holds
LOST = 1e120  # energy of a supposition under which the filter leaves what numbers hold
REPEATS = 10  # noisy values in a row that are the very same number: the output stands still
_USUAL = 3.0  # times as long as nearly all repetitions in a record
_EDGE = 1e-3  # of a state's size: how far inside the domain derivatives are taken (√x has none at 0)


@dataclass(frozen=True)
class Innovations:
    """White innovations along rows: ``nu`` (rows, m) = ``omega`` (rows, m, p) (θ − θ₀) + noise of variance one.

    ``states`` (rows, states): the filter after each row.
    """

    omega: np.ndarray
    nu: np.ndarray
    states: np.ndarray


@dataclass(frozen=True)
class Ahead:
    """The evidence still to come at each decision (the first axis): the blocks of M and μ of engine/onsets.py.

    J and s of a step that begins there are ``ww`` (p × p) and ``w`` (p), of a rise ``rr`` and ``r`` (p, each channel alone).
    """

    vv: np.ndarray
    vw: np.ndarray
    ww: np.ndarray
    vr: np.ndarray
    wr: np.ndarray
    rr: np.ndarray
    v: np.ndarray
    w: np.ndarray
    r: np.ndarray

    def after(self, k: np.ndarray, V: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """D (the diagonal of J) and s of what follows decisions ``k`` if V (k × n × p) and course w (k × p) are there, and w stays."""
        D = np.einsum("kip,kij,kjp->kp", V, self.vv[k], V) + 2 * w * (V * self.vw[k]).sum(axis=1)
        D += w**2 * np.einsum("kpp->kp", self.ww[k])
        return D, (V * self.v[k][:, :, None]).sum(axis=1) + w * self.w[k]


@dataclass(frozen=True)
class Told:
    """Suppositions (the first axis) of each channel (the second), as engine/suppositions.py has them; d from ``begin`` on counts, what
    comes before ``until`` is early (both of each supposition)."""

    onset: np.ndarray
    start: np.ndarray
    rate: np.ndarray
    top: np.ndarray
    bend: np.ndarray
    fade: np.ndarray
    size: np.ndarray
    least: np.ndarray
    most: np.ndarray
    begin: np.ndarray
    until: np.ndarray

    def lanes(self, own: np.ndarray) -> np.ndarray:
        """Numbers × suppositions, in the order of the program's parameters."""
        each = [*(getattr(self, name) for name in COURSE), np.broadcast_to(self.least, self.onset.shape),
                np.broadcast_to(self.most, self.onset.shape), np.broadcast_to(own, self.onset.shape)]  # fmt: skip
        channels = np.stack(each, axis=2).reshape(len(self.onset), -1)
        return np.concatenate([channels.T, self.begin[None], self.until[None]])


@dataclass(frozen=True)
class Sought:
    """What suppositions come to: the first axis; the second, times. J (p × p), s (p), q (m), the diagonal of what of J is early (p),
    the filter's states."""

    J: np.ndarray
    s: np.ndarray
    q: np.ndarray
    early: np.ndarray
    states: np.ndarray


class Filter:
    """The filter of one plant with one noise: values that do not change along a stretch of rows.

    ``patience`` (m): rows after which an output that shows the same number stands still, ∞ where no noise is declared.
    ``doubt``: share of a state's size by which its equation may be off within the plant's time constant.
    """

    def __init__(self, experiment: Engine, context: Context, doubt: float = DOUBT):
        self.experiment, self.context = experiment, context
        self.program = innovations(experiment.plant)
        self.channels = tuple(i for i in experiment.plant.inputs if i.startswith("theta."))
        self.n, self.p, self.m = len(experiment.plant.states), len(self.channels), len(experiment.plant.outputs)
        self.base = np.zeros(self.p)  # θ that belongs to the plant as it is; what is known comes on top
        self.outputs = tuple(experiment.plant.outputs)
        self.stds = noise_stds(experiment.measurement, context)
        outputs = tuple(node for name, node in self.program.outputs.items() if name.startswith(("omega.", "nu.")))
        used = variables(self.program.graph, [*self.program.update, *outputs])
        given = used & set(self.program.inputs)
        self._courses = [(name, int(j)) for name, j in (i.split(".") for i in sorted(given) if i.startswith(("known.", "profile.")))]
        courses = tuple(f"{name}.{j}" for name, j in self._courses)
        self.names = tuple(sorted(given - set(courses)))
        self.layout = Layout(held=(*self.names, *courses), emitted=outputs)
        self.supposed = suppositions(self.program, self.p, self.m)
        used = variables(self.supposed.graph, list(self.supposed.update))
        told = [i for i in self.supposed.inputs if i in used and i not in self.names]
        own = self.supposed.parameters[len(self.program.parameters) :]
        self.lanes = Layout(held=(*self.names, *told), lane_params=own, lanes=WIDTH)
        self.backwards = onsets(self.program, self.n, self.p, self.m)
        handed = parts(self.program)
        self.handing = Layout(held=self.layout.held, emitted=tuple(handed[i] for i in self.backwards.inputs))
        self.interval = experiment.every * experiment.step
        self._measured = [self.names.index(f"measured.{o}") for o in self.outputs]
        hold = np.maximum(1.0, holds(experiment.measurement, experiment.step) / self.interval)
        self.patience = np.where(np.array(experiment.measurement.std) > 0, REPEATS * hold, np.inf)
        values = experiment.parameters | {"interval": self.interval}
        values |= {f"q.{i}": v * (doubt / DOUBT) ** 2 for i, v in enumerate(process_noise(context))}
        values |= {f"R.{k}": float(v) for k, v in enumerate(self._variance())}
        values |= {f"heed.{k}": 1.0 for k in range(self.m)}
        for i, (state, scale) in enumerate(zip(context.model["states"], state_scales(context), strict=True)):
            low, high = state.get("domain") or (None, None)
            edge = _EDGE * scale
            values |= {f"low.{i}": -np.inf if low is None else low + edge, f"high.{i}": np.inf if high is None else high - edge}
        order = self.layout.shared_params(self.program)
        self._params = np.array([values[p] for p in order] or [0.0])
        self._heed = [order.index(f"heed.{k}") for k in range(self.m)]

    def prepare(self) -> None:
        """Have all kernels at hand: compiling one takes up to a second."""
        for program, layout in ((self.program, self.layout), (self.program, self.handing), (self.supposed, self.lanes),
                                (self.backwards, Layout(held=self.backwards.inputs))):  # fmt: skip
            kernel(program, layout)

    def _variance(self) -> np.ndarray:
        """Of one row's y, so that rows count as independent: noise that holds for several rows counts once."""
        variance = self.stds**2
        if self.experiment.measurement.sample_every is not None:
            return variance  # one sample is one value, and enters in one row only
        return variance * np.maximum(1.0, holds(self.experiment.measurement, self.experiment.step) / self.interval)

    def start(self) -> np.ndarray:
        """The plant's initial state as observers take it, V = 0, P from the states' scales."""
        first = np.array([s.get("initial", 0.0) for s in self.context.model["states"]])
        P = np.diag(np.array(state_scales(self.context)) ** 2)
        return np.concatenate([first, np.zeros(self.n * self.p), P[np.triu_indices(self.n)]])

    def table(self, index: np.ndarray, y: np.ndarray, values: dict) -> np.ndarray:
        """What goes in at each row (rows × names): y (rows, m), inputs and signals from ``values``."""
        e = self.experiment
        given = values | {f"measured.{o}": y[:, k] for k, o in enumerate(e.plant.outputs)}
        every = e.measurement.sample_every
        given["fresh"] = 1.0 if every is None else (index // every != (index - e.every) // every) * 1.0
        table = np.empty((len(index), max(1, len(self.names))))
        for c, name in enumerate(self.names):
            table[:, c] = given[name]
        return table

    def run(self, state: np.ndarray, known: np.ndarray, table: np.ndarray, t: np.ndarray, profile: np.ndarray | None = None,
            heed: np.ndarray | None = None) -> Innovations:  # fmt: skip
        """Along rows with inputs ``table`` at times ``t``, θ₀ = ``known`` (p, or rows × p).

        ``profile`` (rows × p): the course of the θ − θ₀ that Ω answers, constant by default; ``heed`` (m): outputs that the
        filter follows, all by default.
        """
        rows, emitted, out = len(t), np.empty((len(t), 1, len(self.layout.emitted))), np.empty((len(t), len(state)))
        kernel(self.program, self.layout)(_rowwise(t), state.copy(), self._told(heed), 1, out, held=self._held(known, table, profile),
                                          emitted=emitted)  # fmt: skip
        shown = emitted[:, 0, :].reshape(rows, self.m, self.p + 1)  # of each output its Ω, then its ν
        return Innovations(shown[:, :, : self.p], shown[:, :, self.p], out)

    def _told(self, heed: np.ndarray | None) -> np.ndarray:
        params = self._params.copy()
        if heed is not None:
            params[self._heed] = heed
        return params

    def _held(self, known: np.ndarray, table: np.ndarray, profile: np.ndarray | None) -> np.ndarray:
        courses = {"known": np.broadcast_to(self.base + known, (len(table), self.p)), "profile": profile}
        held = np.empty((len(table), max(1, len(self.layout.held))))
        held[:, : len(self.names)] = table[:, : len(self.names)]
        for c, (name, j) in enumerate(self._courses, start=len(self.names)):
            held[:, c] = 1.0 if courses[name] is None else courses[name][:, j]
        return held

    def suppose(self, states: np.ndarray, base: np.ndarray, table: np.ndarray, t: np.ndarray, d: np.ndarray, told: Told, heed: np.ndarray,
                stops: np.ndarray) -> Sought:  # fmt: skip
        """Along the same rows under several suppositions: ``states`` (suppositions × states), ``base`` (rows × p): what is known.

        ``d``: times in decisions; ``stops``: numbers of rows after which sums and states are given.
        """
        count, rows = len(states), len(t)
        given = {"d": d} | {f"base.{j}": base[:, j] for j in range(self.p)}
        held = np.empty((rows, len(self.lanes.held)))
        held[:, : len(self.names)] = table[:, : len(self.names)]
        for c, name in enumerate(self.lanes.held[len(self.names) :], start=len(self.names)):
            held[:, c] = given[name]
        run, params, segments = kernel(self.supposed, self.lanes), self._told(heed), _rowwise(t, stops)
        own = told.lanes(self.base)
        found = np.zeros((len(stops), len(self.supposed.states), -(-count // WIDTH) * WIDTH))
        for first in range(0, count, WIDTH):
            pick = np.minimum(np.arange(first, first + WIDTH), count - 1)
            state, out = np.zeros((len(self.supposed.states), WIDTH)), np.empty((len(found), len(self.supposed.states), WIDTH))
            state[: states.shape[1]] = states[pick].T
            run(segments, state, params, 1, out, held=held, lane_params=np.ascontiguousarray(own[:, pick]))
            found[:, :, first : first + WIDTH] = out
        return self._sought(found[:, :, :count].transpose(2, 0, 1))

    def _sought(self, found: np.ndarray) -> Sought:
        n, p, m = found.shape[-1] - len(sums(self.p, self.m)), self.p, self.m
        if not np.isfinite(found.sum()):
            found = np.concatenate([found[..., :n], np.nan_to_num(found[..., n:-m]), np.nan_to_num(found[..., -m:], nan=LOST, posinf=LOST)], axis=-1)
        i, j = np.triu_indices(p)
        ends = n + np.cumsum([p, len(i), p, p, m])
        J = np.empty((*found.shape[:2], p, p))
        J[:, :, i, j] = J[:, :, j, i] = found[:, :, ends[0] : ends[1]]
        s, early, q = (found[:, :, a:b] for a, b in pairwise(ends[1:]))
        return Sought(J, s, q, early, found[:, :, :n])

    def handed(self, state: np.ndarray, known: np.ndarray, table: np.ndarray, t: np.ndarray, heed: np.ndarray) -> np.ndarray:
        """What `ahead` goes by, along rows."""
        handed, out = np.empty((len(t), 1, len(self.backwards.inputs))), np.empty((len(t), len(state)))
        kernel(self.program, self.handing)(_rowwise(t), state.copy(), self._told(heed), 1, out, held=self._held(known, table, None),
                                           emitted=handed)  # fmt: skip
        return handed[::-1, 0].copy()

    def ahead(self, handed: np.ndarray, heed: np.ndarray, stride: int) -> Ahead:
        """What is still to come at every ``stride``-th row, the first and the end of the last included."""
        found, place, blocks = self._backwards(handed, heed, stride, 1.0 / stride, 1.0), 0, {}
        for name, (shape, kept) in forms(self.n, self.p).items():
            entries = tuple(np.array(kept).T)
            block = blocks[name] = np.zeros((len(found), *shape))
            block[(slice(None), *entries)] = found[:, place : place + len(kept)]
            if name in SYMMETRIC:
                block[(slice(None), *entries[::-1])] = found[:, place : place + len(kept)]
            place += len(kept)
        return Ahead(**blocks)

    def bending(self, handed: np.ndarray, heed: np.ndarray, stride: int, tau: float) -> tuple[np.ndarray, np.ndarray]:
        """D and s (each times × p) of rises that bend to their end within ``tau`` decisions, from the same rows on."""
        found = self._backwards(handed, heed, stride, -float(np.expm1(-1 / (tau * stride))), float(np.exp(-1 / (tau * stride))))
        places = {name: len(kept) for name, (_, kept) in forms(self.n, self.p).items()}
        before = sum(count for name, count in places.items() if name not in ("rr", "v", "w", "r"))
        return found[:, before : before + self.p], found[:, -self.p :]

    def _backwards(self, handed: np.ndarray, heed: np.ndarray, stride: int, delta: float, rho: float) -> np.ndarray:
        rows, back = len(handed), self.backwards
        layout, values = Layout(held=back.inputs), {f"heed.{k}": h for k, h in enumerate(heed)} | {"delta": delta, "rho": rho}
        params = np.array([values[name] for name in layout.shared_params(back)])
        found = np.zeros((rows // stride + 1, len(back.states)))
        kernel(back, layout)(_rowwise(np.zeros(rows), np.arange(stride, rows + 1, stride)), np.zeros(len(back.states)), params, 1, found[1:],
                             held=handed)  # fmt: skip
        return found[::-1] if np.isfinite(found.sum()) else np.nan_to_num(found[::-1], posinf=0.0, neginf=0.0)

    def measured(self, table: np.ndarray) -> np.ndarray:
        """What the outputs showed (rows × m), from a table."""
        return table[:, self._measured]

    def unanswered(self, state: np.ndarray) -> np.ndarray:
        """The filter's state with V = 0: as if faults began here."""
        fresh = state.copy()
        fresh[self.n : self.n * (1 + self.p)] = 0.0
        return fresh

    def answers(self, state: np.ndarray) -> np.ndarray:
        """V (n × p) of the filter's state, or states (the last axis)."""
        return state[..., self.n : self.n * (1 + self.p)].reshape(*state.shape[:-1], self.n, self.p)

    def moved(self, state: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The filter's state (or states, the last axis) had it known of a change of θ (p), to which its V is the answer."""
        told = state.copy()
        told[..., : self.n] += (self.answers(state) @ change[..., None])[..., 0]
        return told

    def get_used(self, y: np.ndarray) -> None:
        """Take it as usual that outputs repeat numbers as often as in a record (rows, m): coarse sensors do."""
        for k, column in enumerate(y.T):
            ends = np.flatnonzero(np.diff(column) != 0)
            if len(ends) > 1:
                self.patience[k] = max(self.patience[k], _USUAL * np.quantile(np.diff(ends), 0.99))


def _rowwise(t: np.ndarray, stops: np.ndarray | None = None) -> Segments:
    """Segments of one row each, of which all are recorded, or those that complete so many rows."""
    first = np.full(len(t), 1 if stops is None else NEVER)
    if stops is not None:
        first[stops - 1] = 1
    return Segments(np.ones(len(t), dtype=np.int64), first, t.copy(), np.zeros(len(t)), np.zeros(len(t)))
