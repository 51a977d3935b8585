"""Requests that stopped the service when it did symbolic work and compiled itself: small texts that make large work."""

from collections.abc import Sequence
from typing import Any


def plant(id: str, dynamics: dict[str, str], outputs: int = 1, channels: Sequence[dict[str, Any]] = ()) -> dict:
    """Return a plant as data: its first states are its outputs; without channels the first state has a fault."""
    states = list(dynamics)
    fault = {"name": "fault", "kind": "actuator", "enters": {states[0]: "1"}}
    return {
        "id": id,
        "states": [{"name": name, "initial": 0.1} for name in states],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": f"y{i + 1}", "expression": name} for i, name in enumerate(states[:outputs])],
        "dynamics": dynamics,
        "channels": list(channels) or [fault],
    }


def power(exponent: int = 64) -> dict:
    """Return six states, one of which moves by a power of their sum: an expansion of it has 11 million terms."""
    return plant("power", {name: f"-{name}" for name in "bcdef"} | {"a": f"(a + b + c + d + e + f)^{exponent}"})


def chain(exponent: int = 64) -> dict:
    """Return `power` with the state of the power first, which is the output: it may be a chain of integrators."""
    return plant("chain", {"a": f"(a + b + c + d + e + f)^{exponent}"} | {name: f"-{name}" for name in "bcdef"})


def ring(states: int = 8) -> dict:
    """Return a ring of exponentials: each Lie derivative of the output is several times as long as the last one."""
    names = [f"x{i}" for i in range(states)]
    follow = [(names[(i + 1) % states], names[(i + 2) % states]) for i in range(states)]
    return plant("ring", {name: f"exp({a} * {b})" for name, (a, b) in zip(names, follow, strict=True)})


def products(states: int = 20, each: int = 20) -> dict:
    """Return sums of products of functions: large kernels, for which LLVM takes half a minute."""
    names, functions = [f"x{i}" for i in range(states)], ("sin", "cos", "exp", "tanh")

    def term(i: int, j: int) -> str:
        first, second = functions[(i + j) % 4], functions[(i + 2 * j + 1) % 4]
        return f"{first}({names[j % states]}) * {second}({names[(3 * i + 7 * j + 1) % states]})"

    sums = (" + ".join(term(i, j) for j in range(each)) for i in range(states))
    return plant("products", {name: f"-{name} + {text}" for name, text in zip(names, sums, strict=True)})


def wide(states: int = 60, channels: int = 40) -> dict:
    """Return many states with many fault channels."""
    names = [f"x{i}" for i in range(states)]
    dynamics = {n: f"-{n} + sin({names[(i + 1) % states]}) * {names[(i + 2) % states]}" for i, n in enumerate(names)}
    faults = [
        {"name": f"f{i}", "kind": "process", "enters": {names[i]: f"cos({names[(i + 5) % states]})"}}
        for i in range(channels)
    ]
    return plant("wide", dynamics, states // 3, faults)


def observed(plant: dict, kind: str = "joint-ekf", **changes: object) -> dict:
    """Return an experiment on a plant with an observer of a kind."""
    observer = {"label": "observer", "kind": kind}
    return {"plant": plant, "horizon": 1, "step": 0.001, "observers": [observer], **changes}


def longest(seed: int = 0, **changes: object) -> dict:
    """Return a run of as many steps as are allowed by default, and few rows."""
    return {
        "experiment": "zhao-2012",
        "set": {"horizon": 20_000, "step": 0.001, "record": 1, "evaluate": 1, "seed": seed, "faults": [], **changes},
    }


def later(seed: int = 0, t: float = 90_000) -> dict:
    """Return a session that opens after millions of rows."""
    return {"experiment": "zhao-2012", "t": t, "set": {"seed": seed}}
