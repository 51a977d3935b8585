"""Compare runs with SciPy's Radau at 1e-11, on plants that a fixed step gets wrong or cannot run at all.

    python -m benchmarks.accuracy

prints, for each plant and step, the largest error of a state relative to its largest value, the error that the run
states, and the substeps that it took.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.model.result import Result
from thetascope_schemas import Experiment

Slopes = Callable[[float, np.ndarray], list[float]]


@dataclass(frozen=True)
class Case:
    """A plant as states with initial values and dynamics, a horizon, steps to offer, and its equations in Python."""

    states: dict[str, tuple[float, str]]
    horizon: float
    steps: tuple[float, ...]
    slopes: Slopes
    record: float
    inputs: dict[str, float] = field(default_factory=dict)

    def run(self, step: float) -> Result:
        """Return the run with one step."""
        first = next(iter(self.states))
        plant = {
            "id": "case",
            "states": [{"name": n, "initial": v} for n, (v, _) in self.states.items()],
            "inputs": [{"name": n, "default": v} for n, v in self.inputs.items()],
            "outputs": [{"name": "out", "expression": first}],
            "dynamics": {n: text for n, (_, text) in self.states.items()},
        }
        spec = {"id": "case", "plant": plant, "horizon": self.horizon, "step": step, "evaluate": self.record}
        return prepare(library.resolve(Experiment.model_validate(spec))).run()

    def exact(self, method: str = "Radau") -> np.ndarray:
        """Return the states at the recorded rows (rows, states), by a method of SciPy for stiff equations."""
        t = np.arange(round(self.horizon / self.record) + 1) * self.record
        start = [v for v, _ in self.states.values()]
        exact = solve_ivp(self.slopes, (0, t[-1]), start, method=method, rtol=1e-11, atol=1e-15, t_eval=t)
        return exact.y.T

    def error(self, result: Result, method: str = "Radau") -> float:
        """Return the largest error of a state relative to its largest value; NaN where the run has none."""
        exact = self.exact(method)
        columns = np.stack([result.column(f"x.{s}") for s in self.states], axis=1)
        return float((np.abs(columns - exact).max(axis=0) / np.abs(exact).max(axis=0)).max())


def _reactor(_: float, x: np.ndarray) -> list[float]:
    rate = 7.2e10 * np.exp(-8750 / x[1]) * x[0]
    return [1 - x[0] - rate, 350 - x[1] + 209.2 * rate + 2.09 * (305 - x[1])]


def _tram(_: float, x: np.ndarray) -> list[float]:
    return [0.8 * 600 * 150 / (35000 * max(x[0], 1e-3)) - (0.01 + 1e-3 * x[0] + 1e-4 * x[0] ** 2)]


def _cylinder(_: float, x: np.ndarray) -> list[float]:
    v, p, q = x
    flows = 3e-8 * np.sqrt(2e7 - p) - 1e-3 * v, 1e-3 * v - 3e-8 * np.sqrt(abs(q))
    return [((p - q) * 1e-3 - 500 * v) / 50, 1.4e9 / 2e-4 * flows[0], 1.4e9 / 4e-4 * flows[1]]


CASES = {
    "a tram that starts at a kink": Case(
        {"v": (0.0, "0.8*600*150/(35000*max(v, 0.001)) - (0.01 + 0.001*v + 0.0001*v^2)")}, 2, (0.01, 0.1), _tram, 0.1
    ),
    "a reactor that ignites": Case(
        {
            "c": (0.9, "1 - c - 7.2e10*exp(-8750/T)*c"),
            "T": (305.0, "350 - T + 209.2*7.2e10*exp(-8750/T)*c + 2.09*(305 - T)"),
        },
        6,
        (0.01,),
        _reactor,
        0.1,
    ),
    "Van der Pol, μ = 1000": Case(
        {"x": (1.05, "v"), "v": (-0.01, "1000*(1 - x^2)*v - x")},
        5,
        (0.5,),
        lambda _, x: [x[1], 1000 * (1 - x[0] ** 2) * x[1] - x[0]],
        1.0,
    ),
    "Robertson": Case(
        {
            "a": (1.0, "-0.04*a + 1e4*b*c"),
            "b": (0.0, "0.04*a - 1e4*b*c - 3e7*b^2"),
            "c": (0.0, "3e7*b^2"),
        },
        10,
        (1.0,),
        lambda _, x: [
            -0.04 * x[0] + 1e4 * x[1] * x[2],
            0.04 * x[0] - 1e4 * x[1] * x[2] - 3e7 * x[1] ** 2,
            3e7 * x[1] ** 2,
        ],
        1.0,
    ),
    "a lag of 10 μs": Case(
        {"x": (0.0, "(u - x)/1e-5")}, 0.5, (0.01,), lambda _, x: [(1 - x[0]) / 1e-5], 0.01, {"u": 1.0}
    ),
    "a converter": Case(
        {"i": (0.0, "(12 - v - 0.01*i)/1e-5"), "v": (0.0, "(i - v/2)/1e-4")},
        0.01,
        (1e-3,),
        lambda _, x: [(12 - x[1] - 0.01 * x[0]) / 1e-5, (x[0] - x[1] / 2) / 1e-4],
        1e-3,
    ),
    "Lotka and Volterra": Case(
        {"a": (10.0, "1.1*a - 0.4*a*b"), "b": (5.0, "0.1*a*b - 0.4*b")},
        30,
        (0.1,),
        lambda _, x: [1.1 * x[0] - 0.4 * x[0] * x[1], 0.1 * x[0] * x[1] - 0.4 * x[1]],
        0.5,
    ),
    "dry friction": Case(
        {"x": (0.0, "v"), "v": (1.0, "-x - 0.5*tanh(v/0.001) + sin(2*t)")},
        5,
        (0.01,),
        lambda t, x: [x[1], -x[0] - 0.5 * np.tanh(x[1] / 1e-3) + np.sin(2 * t)],
        0.1,
    ),
    "an orbit in metres": Case(
        {
            "x": (7e6, "vx"),
            "y": (0.0, "vy"),
            "vx": (0.0, "-3.986004418e14*x/(x^2 + y^2)^1.5"),
            "vy": (7546.0, "-3.986004418e14*y/(x^2 + y^2)^1.5"),
        },
        6000,
        (10.0, 100.0),
        lambda _, x: [
            x[2],
            x[3],
            -3.986004418e14 * x[0] / np.hypot(x[0], x[1]) ** 3,
            -3.986004418e14 * x[1] / np.hypot(x[0], x[1]) ** 3,
        ],
        100.0,
    ),
    "a hydraulic cylinder in pascals": Case(
        {
            "v": (0.0, "((p - q)*1e-3 - 500*v)/50"),
            "p": (5e6, "1.4e9/2e-4*(3e-8*sqrt(2e7 - p) - 1e-3*v)"),
            "q": (5e6, "1.4e9/4e-4*(1e-3*v - 3e-8*sqrt(abs(q)))"),
        },
        0.5,
        (0.01,),
        _cylinder,
        0.01,
    ),
    "a ball on a stiff floor": Case(
        {"x": (1.0, "v"), "v": (0.0, "-9.81 + 1e6*max(-x, 0)")},
        1.2,
        (0.01,),
        lambda _, x: [x[1], -9.81 + 1e6 * max(-x[0], 0.0)],
        0.1,
    ),
    "a reversing quadrotor": Case(
        {
            "x": (0.0, "vx"),
            "z": (0.0, "vz"),
            "tilt": (0.1, "rate"),
            "vx": (0.0, "-9.81*sin(tilt)"),
            "vz": (0.0, "9.81*cos(tilt) - 9.81"),
            "rate": (0.0, "-30*tilt - 8*rate + 5*sin(3*t)"),
        },
        5,
        (0.01, 0.05),
        lambda t, x: [
            x[3],
            x[4],
            x[5],
            -9.81 * np.sin(x[2]),
            9.81 * np.cos(x[2]) - 9.81,
            -30 * x[2] - 8 * x[5] + 5 * np.sin(3 * t),
        ],
        0.05,
    ),
    "an induction motor": Case(
        {
            "i": (0.0, "-120*i + 48.7*(10*f + w*g) + 5120*cos(100*t)"),
            "j": (0.0, "-120*j + 48.7*(10*g - w*f) + 5120*sin(100*t)"),
            "f": (0.0, "2*i - 10*f - w*g"),
            "g": (0.0, "2*j - 10*g + w*f"),
            "w": (0.0, "143*(j*f - i*g) - 2.5*w"),
        },
        0.5,
        (1e-4, 1e-3, 1e-2),
        lambda t, x: [
            -120 * x[0] + 48.7 * (10 * x[2] + x[4] * x[3]) + 5120 * np.cos(100 * t),
            -120 * x[1] + 48.7 * (10 * x[3] - x[4] * x[2]) + 5120 * np.sin(100 * t),
            2 * x[0] - 10 * x[2] - x[4] * x[3],
            2 * x[1] - 10 * x[3] + x[4] * x[2],
            143 * (x[1] * x[2] - x[0] * x[3]) - 2.5 * x[4],
        ],
        0.01,
    ),
    "the Oregonator": Case(
        {
            "a": (1.0, "77.27*(b + a*(1 - 8.375e-6*a - b))"),
            "b": (2.0, "(c - (1 + a)*b)/77.27"),
            "c": (3.0, "0.161*(a - c)"),
        },
        360,
        (0.1, 1.0),
        lambda _, x: [
            77.27 * (x[1] + x[0] * (1 - 8.375e-6 * x[0] - x[1])),
            (x[2] - (1 + x[0]) * x[1]) / 77.27,
            0.161 * (x[0] - x[2]),
        ],
        5.0,
    ),
    "a pendulum of 10 kHz": Case(
        {"angle": (1.0, "rate"), "rate": (0.0, "-1e8*sin(angle) - 100*rate")},
        5e-3,
        (1e-6, 1e-5, 1e-4),
        lambda _, x: [x[1], -1e8 * np.sin(x[0]) - 100 * x[1]],
        1e-4,
    ),
    "a tank that runs empty": Case(
        {"h": (4.0, "-0.5*sqrt(max(h, 0))")}, 20, (0.01, 0.1), lambda _, x: [-0.5 * np.sqrt(max(x[0], 0.0))], 0.1
    ),
}


def main() -> None:
    """Print the table."""
    print("| Plant | Step | Error | Stated | Substeps |\n|---|---|---|---|---|")
    for name, case in CASES.items():
        for step in case.steps:
            result = case.run(step)
            known = result.accuracy
            assert known is not None, "steps follow the accuracy"
            steps = f"{known.substeps}" + (f", {known.implicit} implicit" if known.implicit else "")
            print(f"| {name} | {step:g} s | {case.error(result):.1e} | {known.plant:.1e} | {steps} |", flush=True)


if __name__ == "__main__":
    main()
