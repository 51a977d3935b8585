"""The benchmarks' problem: experiment zhao-2012 as the product runs it, and as arrays and equations for others."""

import ctypes
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.inputs.input_tables import RUNGE_KUTTA, Tables
from thetascope.engine.inputs.time_grid import cut
from thetascope.engine.programs.call_plan import plan
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.simulation import Simulation, joined
from thetascope_schemas import Experiment as Spec

HOLD = 10  # steps: noise and switching signals change on multiples of 0.01 s
RHO = LAMBDA = 4.0
INPUTS = ("u.u", "signal.phi1", "signal.phi2", "signal.phi3", "theta.theta1", "theta.theta2", "theta.theta3")
ESTIMATES = ("x.x1", "x.x2", "xh.x1", "xh.x2", "thetah.theta1", "thetah.theta2", "thetah.theta3")
PLACES = [0, 1, 14, 15, 16, 17, 18]  # of the estimates, in the order of the handwritten code


def engine(**changes) -> Experiment:
    """Return the experiment as engine objects; ``changes`` are fields of the spec."""
    spec = library.experiment("zhao-2012").model_dump() | {"figures": []} | changes
    return prepare(library.resolve(Spec.model_validate(spec))).engine


def rows(e: Experiment) -> np.ndarray:
    """Return the inputs of the handwritten code: u, φ1…3, θ1…3, noise, one row per HOLD steps."""
    at = (np.arange(e.steps // HOLD) + 0.5) * HOLD * e.step
    return np.ascontiguousarray(
        np.stack([*(e.signals[n](at, at) for n in INPUTS), e.measurement.noise_at(at)[:, 0]], axis=1)
    )


def start(e: Experiment) -> np.ndarray:
    """Return the initial state in the order of the handwritten code."""
    s = Simulation(e).initial()
    values = dict(zip(e.estimators[0].program.states, s.observers[0], strict=True))
    order = [f"Upsilon.{i}.{j}" for i in range(2) for j in range(3)]
    order += [f"Gamma.{i}.{j}" for i in range(3) for j in range(i, 3)]
    order += ["xh.x1", "xh.x2", "thetah.theta1", "thetah.theta2", "thetah.theta3"]
    return np.concatenate([s.plant, [values[n] for n in order]])


def kernels_alone(e: Experiment) -> tuple[Callable[[], np.ndarray], tuple[str, ...]]:
    """Return a call of the compiled plant and observer over the full horizon with prepared tables, and its states."""
    program = joined(e.plant, e.estimators[0].program)
    signals = e.signals | {"noise.y.y": e.measurement.noises[0]}
    breaks = np.concatenate([s.breaks(0.0, e.steps * e.step) for s in signals.values()])
    grid = cut(0, e.steps, e.step, breaks, e.every, 1)
    tables = Tables(grid, signals, RUNGE_KUTTA)
    call_of, values = plan(program, (), tables.kinds), e.parameters | e.estimators[0].parameters
    params, table = np.array([values[p] for p in call_of.params]), tables.held(call_of.held)
    run, out = call_of.kernel, np.empty((e.steps // e.every, len(program.states)))
    s = Simulation(e).initial()
    begin = np.concatenate([s.plant, s.observers[0]])

    def call() -> np.ndarray:
        run(grid.segments, begin.copy(), params, e.every, out, held=table)
        return out

    return call, program.states


def rates(s: Sequence[float], w: Sequence[float]) -> list[float]:
    """Return the same as reference.c's `rates`, in plain Python, which is faster than NumPy here.

    w: u, φ1…3, θ1…3, noise.
    """
    x1, x2, U00, U01, U02, U10, U11, U12, G00, G01, G02, G11, G12, G22, h1, h2, q1, q2, q3 = s
    u, p1, p2, p3, t1, t2, t3, noise = w
    v = x2 / x1
    O2 = U02 + p3
    b0 = G00 * U00 + G01 * U01 + G02 * O2
    b1 = G01 * U00 + G11 * U01 + G12 * O2
    b2 = G02 * U00 + G12 * U01 + G22 * O2
    r = x1 + p3 * t3 + noise - h1 - p3 * q3
    c1 = max(h1, 1e-3)
    z = min(max(h2 / c1, 0.0), 1.0)
    m1, m2 = U00 * b0 + U01 * b1 + U02 * b2, U10 * b0 + U11 * b1 + U12 * b2
    return [
        x2 - u * x1 + t1 * p1 + t2 * p2,
        x1 * v * (2 * v - 1 - u) + 0.1 * u * (1 - v) * (1 - v),
        RHO * (U10 - U00) + p1,
        RHO * (U11 - U01) + p2,
        RHO * (U12 - U02 - p3),
        -0.5 * RHO * U00,
        -0.5 * RHO * U01,
        -0.5 * RHO * O2,
        LAMBDA * G00 - b0 * b0,
        LAMBDA * G01 - b0 * b1,
        LAMBDA * G02 - b0 * b2,
        LAMBDA * G11 - b1 * b1,
        LAMBDA * G12 - b1 * b2,
        LAMBDA * G22 - b2 * b2,
        h2 - u * h1 + p1 * q1 + p2 * q2 + (RHO + m1) * r,
        c1 * z * (2 * z - 1 - u) + 0.1 * u * (1 - z) * (1 - z) + RHO * (0.5 * RHO + m2) * r,
        b0 * r,
        b1 * r,
        b2 * r,
    ]


@dataclass
class ByHand:
    """The C code, compiled with gcc -O3 -march=native for this machine."""

    library: ctypes.CDLL

    @classmethod
    def compiled(cls, *flags: str) -> "ByHand":
        """Compile reference.c with gcc and further flags, and load it. Raises CalledProcessError."""
        source = Path(__file__).with_name("reference.c")
        with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as folder:
            target = Path(folder) / "reference.so"
            command = ["gcc", "-O3", "-march=native", *flags, "-shared", "-fPIC", "-o", target, source, "-lm"]
            subprocess.run(command, check=True)
            return cls(ctypes.CDLL(str(target)))

    def simulate(self, inputs: np.ndarray, steps: int, h: float, every: int, state: np.ndarray) -> np.ndarray:
        """Return all 19 states after each ``every`` steps."""
        out, s = np.empty((steps // every, 19)), state.copy()
        d, p, n = ctypes.c_double, ctypes.c_void_p, ctypes.c_long
        self.library.simulate(
            p(inputs.ctypes.data),
            n(steps),
            n(HOLD),
            d(h),
            d(RHO),
            d(LAMBDA),
            n(every),
            p(s.ctypes.data),
            p(out.ctypes.data),
        )
        return out

    def batch(
        self, inputs: np.ndarray, h: float, every: int, state: np.ndarray, seeds: range, std: float
    ) -> np.ndarray:
        """Return the states of runs computed one after the other, each with the noise of its seed."""
        count = len(inputs)
        out, scratch = np.empty((len(seeds), count * HOLD // every, 19)), np.empty(count)
        inputs = inputs.copy()
        d, p, n = ctypes.c_double, ctypes.c_void_p, ctypes.c_long
        for i, seed in enumerate(seeds):
            self.library.simulate_seed(
                p(inputs.ctypes.data),
                n(count),
                n(HOLD),
                d(h),
                d(RHO),
                d(LAMBDA),
                n(every),
                p(state.ctypes.data),
                p(out[i].ctypes.data),
                ctypes.c_uint64(seed),
                d(std),
                p(scratch.ctypes.data),
            )
        return out
