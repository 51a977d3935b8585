"""Solve the same problem by scipy's solve_ivp and by python-control, as their users would write it.

    python -m benchmarks others

Both receive a right-hand side in plain Python, which is faster than NumPy on 19 numbers, and are restarted where inputs
or noise jump. They run the first SECONDS of zhao-2012; times are compared per simulated second.
"""

from collections.abc import Callable, Iterator

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.measure import Figure, ratios, rounds
from benchmarks.problem import ESTIMATES, HOLD, PLACES, engine, kernels_alone, rates, rows, start

SECONDS = 1.0
PIECE = HOLD * 0.001  # s, over which all inputs are constant
PIECES = round(SECONDS / PIECE)
TOLERANCE = {"rtol": 1e-6, "atol": 1e-9}
CLOSE = 1e-5  # largest difference from the kernels' results


def figures() -> Iterator[Figure]:
    """Yield the times of other integrators on the same equations, and check that they agree."""
    e = engine()
    call, names = kernels_alone(e)
    picked = [names.index(n) for n in ESTIMATES]
    answer = call()[round(SECONDS / (e.every * e.step)) - 1, picked]
    inputs, state = rows(e)[:PIECES], start(e)
    contenders = {
        "solve_ivp, RK45": lambda: by_scipy(inputs, state, "RK45"),
        "solve_ivp, DOP853": lambda: by_scipy(inputs, state, "DOP853"),
        "python-control": by_control(inputs, state),
    }
    for name, run in contenders.items():
        if not np.abs(run()[PLACES] - answer).max() < CLOSE:
            raise AssertionError(f"{name} does not compute the same")
    seconds = rounds(contenders | {"kernels": call}, 5)
    for name in contenders:
        each = ratios(seconds, name, "kernels", e.steps * e.step / SECONDS)
        yield Figure.of(f"zhao-2012, a simulated second: {name} ÷ kernels", each, "≥ 100")
    yield quiet()


def quiet() -> Figure:
    """Compare without noise at equal accuracy: both integrators may take long steps between the jumps of φ."""
    e, coarse = engine(noise={}), engine(noise={}, step=0.005)
    inputs, state = rows(e)[:PIECES], start(e)
    call, names = kernels_alone(coarse)
    exact = by_scipy(inputs, state, "DOP853", 25, rtol=1e-12, atol=1e-14)[PLACES]
    ours = call()[round(SECONDS / (coarse.every * coarse.step)) - 1, [names.index(n) for n in ESTIMATES]]
    theirs = by_scipy(inputs, state, "RK45", 25)[PLACES]
    if not max(np.abs(ours - exact).max(), np.abs(theirs - exact).max()) < CLOSE:
        raise AssertionError("kernels and solve_ivp do not agree")
    seconds = rounds({"RK45": lambda: by_scipy(inputs, state, "RK45", 25), "kernels": call}, 15)
    each = ratios(seconds, "RK45", "kernels", e.steps * e.step / SECONDS)
    return Figure.of("without noise, as accurate with 5 ms: solve_ivp, RK45 ÷ kernels", each)


def by_scipy(inputs: np.ndarray, state: np.ndarray, method: str, together: int = 1, **tolerance: float) -> np.ndarray:
    """Return the state at the end of the inputs' rows, which are constant over ``together`` rows at a time."""
    length = together * PIECE
    for i in range(0, len(inputs), together):
        w = inputs[i].tolist()
        solution = solve_ivp(
            lambda t, s, w=w: rates(s.tolist(), w), (0.0, length), state, method=method, **(tolerance or TOLERANCE)
        )
        state = solution.y[:, -1]
    return state


def by_control(inputs: np.ndarray, state: np.ndarray) -> Callable[[], np.ndarray]:
    """Return a call of python-control's nonlinear input/output system, simulated in pieces by its default method."""
    import control

    def update(t: float, x: np.ndarray, u: np.ndarray, params: dict) -> list[float]:
        return rates(x.tolist(), u.tolist())

    system = control.nlsys(update, None, inputs=8, states=19)
    times = np.array([0.0, PIECE])

    def run() -> np.ndarray:
        s = state
        for row in inputs:
            held = np.repeat(row[:, None], 2, axis=1)
            answer = control.input_output_response(system, times, held, s, solve_ivp_kwargs=TOLERANCE)
            s = answer.states[:, -1]
        return s

    return run
