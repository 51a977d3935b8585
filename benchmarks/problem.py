"""The benchmark's problem: experiment zhao-2012 as the product runs it, and as arrays for the code written by hand."""

import ctypes
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from backend import library
from backend.assembly import prepare
from backend.engine.simulation import Experiment, Simulation
from shared import Experiment as Spec

HOLD = 10  # steps: noise and switching signals change on multiples of 0.01 s


def engine(record: float = 0.01, **changes) -> Experiment:
    spec = library.experiment("zhao-2012").model_dump() | {"record": record} | changes
    return prepare(Spec.model_validate(spec)).engine


def rows(e: Experiment) -> np.ndarray:
    """Inputs of the hand-written code: u, φ1…3, θ1…3, noise, a row each HOLD steps."""
    at = (np.arange(e.steps // HOLD) + 0.5) * HOLD * e.step
    names = ("u.u", "signal.phi1", "signal.phi2", "signal.phi3", "theta.theta1", "theta.theta2", "theta.theta3")
    return np.ascontiguousarray(np.stack([*(e.signals[n](at, at) for n in names), e.measurement.noise_at(at)[:, 0]], axis=1))


def start(e: Experiment) -> np.ndarray:
    """Initial state in the order of the hand-written code."""
    s = Simulation(e).initial()
    values = dict(zip(e.estimators[0].program.states, s.observers[0], strict=True))
    order = [f"Upsilon.{i}.{j}" for i in range(2) for j in range(3)]
    order += [f"Gamma.{i}.{j}" for i in range(3) for j in range(i, 3)]
    order += ["xh.x1", "xh.x2", "thetah.theta1", "thetah.theta2", "thetah.theta3"]
    return np.concatenate([s.plant, [values[n] for n in order]])


@dataclass
class ByHand:
    """The C code, compiled with gcc -O3 -march=native for this machine."""

    library: ctypes.CDLL

    @classmethod
    def compiled(cls) -> "ByHand":
        folder = tempfile.mkdtemp(prefix="thetascope-benchmark-")
        target = Path(folder) / "reference.so"
        source = Path(__file__).with_name("reference.c")
        subprocess.run(["gcc", "-O3", "-march=native", "-shared", "-fPIC", "-o", target, source, "-lm"], check=True)
        return cls(ctypes.CDLL(str(target)))

    def simulate(self, inputs: np.ndarray, steps: int, h: float, every: int, state: np.ndarray) -> np.ndarray:
        out, s = np.empty((steps // every, 19)), state.copy()
        d = ctypes.c_double
        self.library.simulate(inputs.ctypes.data_as(ctypes.c_void_p), ctypes.c_long(steps), ctypes.c_long(HOLD), d(h), d(4.0),
                              d(4.0), ctypes.c_long(every), s.ctypes.data_as(ctypes.c_void_p),
                              out.ctypes.data_as(ctypes.c_void_p))  # fmt: skip
        return out

    def batch(self, inputs: np.ndarray, h: float, every: int, state: np.ndarray, seeds: range, std: float) -> np.ndarray:
        """Runs one after the other, each with noise of its own seed."""
        count = len(inputs)
        out, scratch = np.empty((len(seeds), count * HOLD // every, 19)), np.empty(count)
        inputs = inputs.copy()
        d, p = ctypes.c_double, ctypes.c_void_p
        for i, seed in enumerate(seeds):
            self.library.simulate_seed(inputs.ctypes.data_as(p), ctypes.c_long(count), ctypes.c_long(HOLD), d(h), d(4.0), d(4.0),
                                       ctypes.c_long(every), state.ctypes.data_as(p), p(out[i].ctypes.data),
                                       ctypes.c_uint64(seed), d(std), scratch.ctypes.data_as(p))  # fmt: skip
        return out
