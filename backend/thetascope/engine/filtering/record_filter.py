"""RecordFilter: the loops of this folder for one plant, with NumPy arrays."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.filtering import filter_loop, flow, onset_bank
from thetascope.engine.filtering.bundles import Alarms, Bank, Equations, Faults, Noise, Path, Rows
from thetascope.engine.filtering.plant_functions import PlantFunctions
from thetascope.engine.loops.kernels import LoopKernel, compile_loops

BLOCK = 4096  # rows
SLOTS = 96  # onsets that are watched at the same time: two for each doubling of the age, and the youngest ones


@dataclass(frozen=True)
class FilterResult:
    """A filtered record.

    Attributes:
        loss: −2 log L.
        path: the linearised filter along the rows.
        z, P: the prediction after the last row.
    """

    loss: float
    path: Path
    z: np.ndarray
    P: np.ndarray


@lru_cache(maxsize=64)
def _kernels(plant: Program, directions: tuple[str, ...], coloured: bool) -> dict[str, LoopKernel]:
    """Return the compiled loops for a plant."""
    functions = PlantFunctions(plant, directions)
    n, m = len(plant.states), len(plant.outputs)
    sizes = {
        "n": n,
        "m": m,
        "na": n + m * coloured,
        "d": len(directions),
        "p": len(functions.faults),
        "nu": len(functions.inputs),
        "npar": len(plant.parameters),
        "discrete": int(plant.time == DISCRETE),
    }
    filtering = [filter_loop.filter_rows, filter_loop.flow_rows, filter_loop.simulate_rows]
    scanning = [onset_bank.scan, onset_bank.respond_to_courses]
    inner = [
        flow.stage,
        flow.runge_kutta,
        flow.invert,
        flow.rosenbrock,
        flow.flow,
        flow.read,
        filter_loop.correct,
        filter_loop.spread_ahead,
    ]
    inner += [onset_bank.respond, onset_bank.carry, onset_bank.open_onset, onset_bank.watched, onset_bank.compare]
    key = repr((plant.digest, directions))
    return compile_loops([*filtering, *scanning], inner, sizes, functions.externals(), functions.text, key)


class RecordFilter:
    """The filter of one plant.

    Args:
        plant: its program.
        directions: faults (``theta.*``) or parameters whose effect is derived; a fault's unit is `scale`.
        scale: (directions,), typical sizes.
        par: (parameters,), in the program's order.
        low, high: (n,), bounds of the states, ±∞ for none.
    """

    def __init__(
        self,
        plant: Program,
        directions: tuple[str, ...],
        scale: np.ndarray,
        par: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
    ):
        functions = PlantFunctions(plant, directions)
        self.plant, self.directions, self.scale = plant, directions, np.asarray(scale, dtype=float)
        self.faults = functions.faults
        self.n, self.m, self.p, self.d = len(plant.states), len(plant.outputs), len(functions.faults), len(directions)
        self._none: dict[int, Faults] = {}
        self.equations = Equations(*(np.array(a, dtype=float) for a in (par, low, high, np.arange(self.d))))
        self._chosen: dict[tuple[int, ...], Equations] = {}

    def with_parameters(self, par: np.ndarray) -> "RecordFilter":
        """Return the filter of the plant with other parameters."""
        low, high = self.equations.low, self.equations.high
        return RecordFilter(self.plant, self.directions, self.scale, par, low, high)

    def _equations(self, channels: tuple[int, ...]) -> Equations:
        """Return the equations with some directions chosen."""
        if channels not in self._chosen:
            chosen = np.zeros(self.d)
            chosen[: len(channels)] = channels
            self._chosen[channels] = replace(self.equations, chosen=chosen)
        return self._chosen[channels]

    def no_faults(self, rows: int) -> Faults:
        """Return θ = 0 along rows, the same arrays for every call."""
        if rows not in self._none:
            self._none = {rows: Faults(np.zeros((rows, self.p)), np.zeros((rows, self.p)))}
        return self._none[rows]

    def new_path(self, rows: int, coloured: bool) -> Path:
        """Return an empty path."""
        n, m, d = self.n, self.m, self.d
        na = n + m * coloured
        shapes = [(n,), (n,), (n, n), (n, d), (n,), (m,), (m, n), (m, d), (m, na), (m,), (m,), (na,), (na,)]
        return Path(*(np.zeros((rows, *shape)) for shape in shapes))

    def filter(
        self,
        data: Rows,
        noise: Noise,
        z: np.ndarray,
        P: np.ndarray,
        faults: Faults | None = None,
        path: Path | None = None,
        frozen: bool = False,
        channels: Sequence[int] | None = None,
    ) -> FilterResult:
        """Filter rows.

        Args:
            data, noise: the rows; the noise, with a coloured part if z has states for it.
            z, P: the prediction for the first row.
            faults: known faults; None: none.
            path: the path that is overwritten; its linearisation is used if `frozen`.
            channels: the directions for which G is needed; None: all. The others count as 0 in ``path.G``.
        """
        rows, coloured = len(data.t), len(z) > self.n
        path = path or self.new_path(rows, coloured)
        z, P = np.array(z, dtype=float), np.array(P, dtype=float)
        loss = _kernels(self.plant, self.directions, coloured)["filter_rows"](
            rows=rows,
            extras=len(data.extra),
            linearise=int(not frozen),
            used=self.d if channels is None else len(channels),
            plant=self.equations if channels is None else self._equations(tuple(channels)),
            noise=noise,
            data=data,
            faults=faults or self.no_faults(rows),
            path=path,
            z=z,
            P=P,
        )
        if not frozen:
            path.G *= self.scale
            path.J *= self.scale
        return FilterResult(loss, path, z, P)

    def blocks(
        self, data: Rows, noise: Noise, z: np.ndarray, P: np.ndarray, faults_of: Callable[[Rows], Faults] | None = None
    ) -> Iterator[tuple[int, Rows, FilterResult]]:
        """Filter rows in blocks, whose memory does not grow with the record: yield first row, rows and result of each.

        Args:
            data, noise, z, P: as in `filter`.
            faults_of: the known faults along some rows; None: none.
        """
        for begin in range(0, len(data.t), BLOCK):
            part = part_of(data, begin, min(begin + BLOCK, len(data.t)))
            result = self.filter(part, noise, z, P, None if faults_of is None else faults_of(part))
            yield begin, part, result
            z, P = result.z, result.P

    def flows(self, data: Rows, x: np.ndarray) -> np.ndarray:
        """Return the states (rows, n) at the ends of the intervals that begin with the states x (rows, n)."""
        rows, end = len(data.t), np.empty((len(data.t), self.n))
        _kernels(self.plant, self.directions, False)["flow_rows"](
            rows=rows,
            extras=len(data.extra),
            plant=self.equations,
            data=data,
            faults=self.no_faults(rows),
            x=np.ascontiguousarray(x),
            end=end,
        )
        return end

    def simulate(self, data: Rows, start: np.ndarray, faults: Faults | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return states (rows, n) and outputs (rows, m) from `start` on, without corrections."""
        rows = len(data.t)
        x, y = np.empty((rows, self.n)), np.empty((rows, self.m))
        _kernels(self.plant, self.directions, False)["simulate_rows"](
            rows=rows,
            extras=len(data.extra),
            plant=self.equations,
            data=data,
            faults=faults or self.no_faults(rows),
            start=np.array(start, dtype=float),
            x=x,
            y=y,
        )
        return x, y

    def new_bank(self, replicas: int, coloured: bool, slots: int = SLOTS) -> Bank:
        """Return a bank in which no onset is watched."""
        na, columns = self.n + self.m * coloured, 2 * self.d
        zeros = np.zeros
        free = np.full(slots, -1.0)
        return Bank(
            free, zeros(slots), zeros((slots, na, columns)), zeros((slots, replicas, columns)), zeros((slots, columns))
        )

    def scan(
        self,
        data: Rows,
        noise: Noise,
        path: Path,
        bank: Bank,
        first: int,
        tick: float,
        used: np.ndarray,
        nu: np.ndarray,
    ) -> Alarms:
        """Return the statistics of rows, and update the bank.

        Args:
            first: number of the first row.
            tick: unit of time of ramps, s.
            used: (2·directions,), 1 for columns that count: steps, then ramps.
            nu: (replicas, rows, m), innovations.
        """
        rows, replicas = len(data.t), len(nu)
        alarms = Alarms(np.zeros((rows, replicas)), *(np.full(rows, -1.0) for _ in range(3)))
        _kernels(self.plant, self.directions, path.z.shape[1] > self.n)["scan"](
            rows=rows,
            extras=len(data.extra),
            replicas=replicas,
            slots=len(bank.onset),
            first=first,
            tick=tick,
            noise=noise,
            data=data,
            path=path,
            nu=np.ascontiguousarray(nu),
            used=used,
            bank=bank,
            alarms=alarms,
        )
        return alarms

    def responses(
        self,
        data: Rows,
        noise: Noise,
        path: Path,
        channel: np.ndarray,
        interval: np.ndarray,
        row: np.ndarray,
        start: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return the response (courses, rows, m) of the innovations to courses, each of one direction.

        Args:
            channel: (courses,), the place of the direction.
            interval, row: (courses, rows), in multiples of its `scale`: means over intervals, values in rows.
            start: (courses, na), changes of the first prediction; None: none.
        """
        courses, rows, na = len(interval), len(data.t), path.z.shape[1]
        omega = np.empty((courses, rows, self.m))
        _kernels(self.plant, self.directions, na > self.n)["respond_to_courses"](
            rows=rows,
            extras=len(data.extra),
            courses=courses,
            noise=noise,
            data=data,
            path=path,
            channel=np.array(channel, dtype=float),
            interval=np.ascontiguousarray(interval),
            row=np.ascontiguousarray(row),
            start=np.zeros((courses, na)) if start is None else np.ascontiguousarray(start),
            omega=omega,
        )
        return omega


def part_of(data: Rows, begin: int, end: int) -> Rows:
    """Return rows begin … end − 1."""
    rows = slice(begin, end)
    cut = {name: getattr(data, name)[rows] for name in ("t", "width", "steps", "u", "between", "y", "extra_at")}
    return replace(data, **cut)
