"""Evaluation of a program's outputs along recorded rows with compiled code, which rounds exactly as the run does."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import NEVER, Kernel, Layout, Segments, kernel
from thetascope.engine.compiler.system import DISCRETE, Program


def probe(program: Program, names: Sequence[str], values: Mapping[str, np.ndarray | float]) -> np.ndarray:
    """Return outputs (by name; ``d.<state>`` for an update) at each row: shape (names, rows).

    ``values`` maps states, inputs, parameters and ``t`` to arrays over the rows, or to numbers that apply to all rows.
    """
    needed = _needed(program, tuple(names))
    arrays = {n: np.asarray(values[n], dtype=float) for n in needed}
    fixed = tuple(n for n in needed if arrays[n].ndim == 0)
    moving = tuple(n for n in needed if arrays[n].ndim == 1)
    t = np.atleast_1d(np.asarray(values["t"], dtype=float))
    rows = len(t)
    result = np.empty((rows, 1, len(names)))
    if not names or not rows:
        return np.empty((len(names), rows))
    run = _kernel(program, tuple(names), fixed, moving)
    staged = np.empty((rows, max(1, len(moving))))
    for j, name in enumerate(moving):
        staged[:, j] = arrays[name]
    ones = np.ones(rows, dtype=np.int64)
    segments = Segments(ones, ones * NEVER, t.copy(), np.zeros(rows), np.zeros(rows))
    params = np.array([float(arrays[n]) for n in fixed] or [0.0])
    run(segments, np.zeros(1), params, 1, np.zeros(1), staged=staged, emitted=result)
    return np.ascontiguousarray(result[:, 0, :].T)


def _roots(program: Program, names: tuple[str, ...]) -> list[int]:
    """Return the nodes of outputs and of updates (``d.<state>``)."""
    position = {s: i for i, s in enumerate(program.states)}
    return [program.update[position[n[2:]]] if n.startswith("d.") else program.outputs[n] for n in names]


@lru_cache(maxsize=256)
def _needed(program: Program, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the variables that these outputs depend on, without t."""
    return tuple(sorted(variables(program.graph, _roots(program, names)) - {"t"}))


@lru_cache(maxsize=256)
def _kernel(program: Program, names: tuple[str, ...], fixed: tuple[str, ...], moving: tuple[str, ...]) -> Kernel:
    """Return the kernel that emits these outputs. Cached by the arguments: the digest of a new program takes time."""
    bare = replace(program, time=DISCRETE, states=(), update=(), parameters=fixed, inputs=moving)
    return kernel(bare, Layout(staged=moving, emitted=tuple(_roots(program, names))))
