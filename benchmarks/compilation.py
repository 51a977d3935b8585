"""Measure the time from text to the first estimate, and that of a library experiment from the cache, in seconds.

    python -m benchmarks compilation

Caches are temporary folders, empty at first. The first estimate is the first recorded row after t = 0. The time
includes everything before it: parsing and checking the text, symbolic mathematics, lowering, machine code, the step.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import sympy  # noqa: F401  (a server has imported it by its first plant)

from benchmarks.measure import Figure
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.compiler import cache
from thetascope.engine.simulation.simulation import Simulation
from thetascope_schemas import Experiment

ROOT = Path(__file__).parents[1]
TEXT, LIBRARY = 0.5, 0.02  # s, targets

# all modules are imported in advance, so that imports are not counted
IN_NEW_PROCESS = """
import sys, time
import numpy.ma
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.observers import registry
from thetascope.engine.simulation.simulation import Simulation
for kind in registry.kinds():
    registry.observer(kind)
begin = time.perf_counter()
engine = prepare(library.resolve(library.experiment("zhao-2012"))).engine
simulation = Simulation(engine)
state, rows = simulation.advance(simulation.initial(), engine.every + 1)
seconds = time.perf_counter() - begin
print(seconds, len(rows.observers[0]) == 2 and "sympy" not in sys.modules)
"""
COLD = """
import json, sys
from benchmarks.compilation import first_estimate
first_estimate(json.load(sys.stdin))
"""


def figures() -> Iterator[Figure]:
    """Yield the times of compiling, with a temporary cache folder that is empty at first."""
    with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as folder:
        before = os.environ.get("THETASCOPE_CACHE")
        os.environ["THETASCOPE_CACHE"] = folder
        cache.folder.cache_clear()
        try:
            yield from texts()
            yield cold()
            yield from_cache()
            yield large()
        finally:
            cache.folder.cache_clear()
            os.environ.pop("THETASCOPE_CACHE")
            os.environ |= {"THETASCOPE_CACHE": before} if before is not None else {}


def first_estimate(spec: dict) -> float:
    """Return the seconds from the spec as JSON to the first estimate."""
    begin = time.perf_counter()
    engine = prepare(library.resolve(Experiment.model_validate(spec))).engine
    simulation = Simulation(engine)
    _, rows = simulation.advance(simulation.initial(), engine.every + 1)
    seconds = time.perf_counter() - begin
    if len(rows.observers[0]) != 2:
        raise AssertionError("the first estimate is missing")
    return seconds


def fresh(plant: str, observer: str, draw: random.Random) -> dict:
    """Return a plant whose text is in no cache: every equation has new coefficients."""
    data = library.plant(plant).model_dump(mode="json") | {"id": "fresh"}
    data["dynamics"] = {s: f"{1 + 0.01 * draw.random()!r}*({text})" for s, text in data["dynamics"].items()}
    return {
        "plant": data,
        "horizon": 1.0,
        "step": 0.001,
        "evaluate": 0.01,
        "observers": [{"label": "o", "kind": observer}],
    }


def texts(count: int = 9) -> Iterator[Figure]:
    """Yield the time from a plant's text to its first rows, for plants that are in no cache."""
    draw = random.Random()
    for plant, observer in (
        ("zhao-contois", "zhao-adaptive"),
        ("contois-physical", "zhao-adaptive"),
        ("dc-motor", "adaptive-kalman"),
        ("dts200", "adaptive-kalman"),
    ):
        seconds = [first_estimate(fresh(plant, observer, draw)) for _ in range(count)]
        yield Figure.of(f"new text, SymPy imported: {plant} with {observer}", seconds, f"≤ {TEXT} s", "s")


def cold(count: int = 5) -> Figure:
    """Return the time of a new process, including Python's start and all imports."""
    draw, seconds = random.Random(), []
    for _ in range(count):
        text = json.dumps(fresh("zhao-contois", "zhao-adaptive", draw))
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", COLD], input=text, text=True, cwd=ROOT, check=True)
        seconds.append(time.perf_counter() - begin)
    return Figure.of("new text, new process, all imports included: zhao-contois", seconds, "", "s")


def from_cache(count: int = 15) -> Figure:
    """Return the time with a full cache; the first process fills it and is not counted."""
    command, seconds = [sys.executable, "-c", IN_NEW_PROCESS], []
    for i in range(count + 1):
        took, good = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True).stdout.split()
        if i:
            seconds.append(float(took))
            if good != "True":
                raise AssertionError("the estimate is missing, or SymPy was needed for it")
    return Figure.of(
        "zhao-2012 in a new process from the cache, imports apart", seconds, f"≤ {1000 * LIBRARY:g} ms", "ms"
    )


def large(n: int = 30, p: int = 5, count: int = 3) -> Figure:
    """Return the time of a chain of n states with p faults: Υ has n·p, Γ p(p+1)/2, x̂ and θ̂ n + p states."""
    seconds, draw = [], random.Random()
    for _ in range(count):
        x = [f"x{i + 1}" for i in range(n)]
        dynamics = {a: f"{b} - {1 + draw.random()!r}*{a}" for a, b in pairwise(x)}
        dynamics[x[-1]] = " - ".join(["u", *(f"{draw.random()!r}*sin({s})" for s in x)])
        plant = {
            "id": "chain",
            "title": f"A chain of {n}",
            "time": {"kind": "continuous"},
            "states": [{"name": s, "initial": 0.1} for s in x],
            "inputs": [{"name": "u"}],
            "outputs": [{"name": "y", "expression": "x1"}],
            "dynamics": dynamics,
            "channels": [{"name": f"f{j}", "kind": "actuator", "enters": {x[j * n // p]: "1"}} for j in range(p)],
        }
        spec = {
            "plant": plant,
            "horizon": 1.0,
            "step": 0.001,
            "evaluate": 0.01,
            "observers": [{"label": "o", "kind": "zhao-adaptive"}],
        }
        seconds.append(first_estimate(spec))
    states = n * p + p * (p + 1) // 2 + n + p
    return Figure.of(f"new text of {n} states, observer of {states}", seconds, "seconds", "s")
