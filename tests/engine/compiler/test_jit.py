"""Compiled kernels: the same numbers as NumPy, whatever the lanes, segments and size."""

import numpy as np
import pytest
import sympy

from thetascope.engine.compiler import jit
from thetascope.engine.compiler.codegen import fits_inline
from thetascope.engine.compiler.jit import NEVER, Layout, Segments, kernel
from thetascope.engine.compiler.system import Program, System
from thetascope.engine.programs import evaluate_rows


def program(time: str = "continuous") -> Program:
    """Return a program with two states, a held input u, a staged input w, a parameter k, time, and C functions."""
    x, v, u, w, k, t = sympy.symbols("x v u w k t", real=True)
    update = (v + sympy.sin(t) * w, -k * sympy.sin(x) - v / 3 + u + sympy.exp(-(x**2)) * sympy.tanh(v))
    return System("p", time, (x, v), (u, w), (k,), update, {"y": x * v + w}).lower()


def segments(count: int, each: int, h: float, every: int) -> Segments:
    n = np.full(count, each, dtype=np.int64)
    first = np.full(count, every if each >= every else NEVER, dtype=np.int64)
    return Segments(n, first, np.zeros(count), np.arange(count) * float(each), np.full(count, h))


def by_hand(p: Program, state: np.ndarray, h: float, u: np.ndarray, w: np.ndarray, k: float, each: int) -> np.ndarray:
    """Return the classical Runge–Kutta scheme in NumPy, one row per step."""
    rows, x = [], state.copy()

    def rate(z: np.ndarray, t: float, i: int, s: int) -> np.ndarray:
        values = dict(zip(p.states, z, strict=True)) | {"u": u[i // each], "w": w[i, s], "k": k, "t": t}
        return np.array([float(v) for v in p.evaluate([f"d.{n}" for n in p.states], values)])

    for i in range(len(w)):
        t = i * h
        k1 = rate(x, t, i, 0)
        k2 = rate(x + h / 2 * k1, t + h / 2, i, 1)
        k3 = rate(x + h / 2 * k2, t + h / 2, i, 2)
        k4 = rate(x + h * k3, t + h, i, 3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        rows.append(x)
    return np.array(rows)


@pytest.fixture(scope="module")
def inputs() -> dict:
    rng = np.random.default_rng(1)
    return {"u": rng.normal(size=20), "w": rng.normal(size=(100, 4)), "state": np.array([0.3, -0.2])}


def run(inputs: dict, layout: Layout, state: np.ndarray, **arrays) -> np.ndarray:
    out = np.empty((100, 2, layout.lanes)) if layout.lanes > 1 else np.empty((100, 2))
    kernel(program(), layout)(segments(20, 5, 0.02, 1), state, np.array([2.0]), 1, out, **arrays)
    return out


def test_the_kernel_is_runge_kutta(inputs):
    """It equals the scheme written in NumPy to rounding."""
    state = inputs["state"].copy()
    out = run(inputs, Layout(held=("u",), staged=("w",)), state, held=inputs["u"], staged=inputs["w"])
    expected = by_hand(program(), inputs["state"], 0.02, inputs["u"], inputs["w"], 2.0, 5)
    np.testing.assert_allclose(out, expected, rtol=1e-13, atol=1e-15)
    np.testing.assert_array_equal(state, out[-1])


@pytest.mark.parametrize("lanes", [2, 4, 8, 16])
def test_every_lane_has_the_bits_of_the_single_run(inputs, lanes):
    """Lanes differ in parameter, held input and state; each equals its own scalar run bit for bit."""
    rng = np.random.default_rng(2)
    k, state = rng.uniform(1, 3, lanes), rng.normal(size=(2, lanes))
    u = rng.normal(size=(20, 1, lanes))
    layout = Layout(lane_held=("u",), staged=("w",), lane_params=("k",), lanes=lanes)
    together = run(inputs, layout, state.copy(), lane_held=u, staged=inputs["w"], lane_params=k)
    for lane in range(lanes):
        alone = np.empty((100, 2))
        start = np.ascontiguousarray(state[:, lane])
        kernel(program(), Layout(held=("u",), staged=("w",)))(
            segments(20, 5, 0.02, 1),
            start,
            k[lane : lane + 1].copy(),
            1,
            alone,
            held=np.ascontiguousarray(u[:, 0, lane]),
            staged=inputs["w"],
        )
        np.testing.assert_array_equal(together[:, :, lane], alone)


def test_recording_every_third_step_gives_those_rows(inputs):
    """``first`` and ``every`` select rows; they change no number."""
    everything = run(
        inputs, Layout(held=("u",), staged=("w",)), inputs["state"].copy(), held=inputs["u"], staged=inputs["w"]
    )
    ones = np.array([100], dtype=np.int64)
    some = np.empty((33, 2))
    steady = np.zeros(1)
    kernel(program(), Layout(held=("u",), staged=("w",)))(
        Segments(ones, np.array([3], dtype=np.int64), steady, steady, np.array([0.02])),
        inputs["state"].copy(),
        np.array([2.0]),
        3,
        some,
        held=inputs["u"][:1].copy(),
        staged=inputs["w"],
    )
    same_u = run(
        {**inputs, "u": np.full(20, inputs["u"][0])},
        Layout(held=("u",), staged=("w",)),
        inputs["state"].copy(),
        held=np.full(20, inputs["u"][0]),
        staged=inputs["w"],
    )
    np.testing.assert_array_equal(some, same_u[2:99:3])
    assert not np.array_equal(same_u, everything)


def chained(n: int) -> Program:
    """Return a large coupled system: n states, each driven by all others through a sine."""
    x = sympy.symbols(f"x0:{n}", real=True)
    update = tuple(
        -x[i] + sum(sympy.Float(0.01 * (i + 2 * j)) * sympy.sin(x[j] - x[i]) for j in range(n)) for i in range(n)
    )
    return System("large", "continuous", x, (), (), update).lower()


def test_large_programs_are_compiled_out_of_line_with_the_same_numbers():
    """Above the inline limit the right-hand side is a function; RK4 gives the same numbers."""
    p = chained(32)
    assert not fits_inline(p, Layout())
    start = np.linspace(-1, 1, 32)
    out, state = np.empty((5, 32)), start.copy()
    kernel(p, Layout())(segments(1, 5, 0.01, 1), state, np.zeros(1), 1, out)

    def rate(z: np.ndarray) -> np.ndarray:
        difference = np.sin(z[None, :] - z[:, None])
        weight = 0.01 * (np.arange(32)[:, None] + 2 * np.arange(32)[None, :])
        return -z + (weight * difference).sum(axis=1)

    x, h = start, 0.01
    for row in out:
        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        k4 = rate(x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        np.testing.assert_allclose(row, x, rtol=1e-10, atol=1e-13)


def test_discrete_programs_map_the_state_once_per_step(inputs):
    """The update is applied once per step."""
    p = program("discrete")
    out, state = np.empty((4, 2)), inputs["state"].copy()
    w = inputs["w"][:4, 0].copy()
    kernel(p, Layout(held=("u",), staged=("w",)))(
        segments(1, 4, 0.1, 1), state, np.array([2.0]), 1, out, held=inputs["u"][:1].copy(), staged=w
    )
    x = inputs["state"]
    for i in range(4):
        values = dict(zip(p.states, x, strict=True)) | {"u": inputs["u"][0], "w": w[i], "k": 2.0, "t": i * 0.1}
        x = np.array([float(v) for v in p.evaluate(["d.x", "d.v"], values)])
        np.testing.assert_allclose(out[i], x, rtol=1e-14)


def test_code_that_is_compiled_fast_rounds_like_code_that_runs_fast(monkeypatch):
    """A large program along 500 rows has the same bits from both of LLVM's code generators."""
    program = chained(40)
    names = [f"d.{state}" for state in program.states]
    draw = np.random.default_rng(3)
    values = {n: draw.uniform(0.5, 2.0, 500) for n in (*program.states, *program.inputs, *program.parameters)}
    compile_to_object, used, results = jit._object_code, [], []
    monkeypatch.setattr(jit.cache, "read", lambda *key: None)
    for quick in (True, False):

        def chosen(text: str, optimised: bool, fast: bool, quick: bool = quick) -> bytes:
            used.append(fast)
            return compile_to_object(text, optimised, quick)

        monkeypatch.setattr(jit, "_object_code", chosen)
        evaluate_rows._kernel.cache_clear()
        kernel.cache_clear()
        results.append(evaluate_rows.probe(program, names, values | {"t": np.arange(500.0)}))
    assert used == [True, True]  # it is large, so a run compiles it fast
    assert np.isfinite(results[0]).all() and results[0].tobytes() == results[1].tobytes()
