"""The kinds of observers, in the order in which they are offered. Adding one is one file and one line here."""

from functools import lru_cache
from importlib import import_module

from backend.engine.errors import SpecError
from backend.engine.observers.base import Observer

_MODULES = {
    "high-gain": "high_gain",
    "zhao-adaptive": "zhao",
    "nonsmooth-adaptive": "nonsmooth_adaptive",
    "linear-adaptive": "linear_adaptive",
    "reduced-order": "reduced_order",
    "full-order": "full_order",
    "sandwich-nonsmooth": "sandwich_nonsmooth",
    "sandwich-conventional": "sandwich_conventional",
    "adaptive-kalman": "adaptive_kalman",
    "adaptive-kalman-discrete": "adaptive_kalman_discrete",
    "joint-ekf": "joint_ekf",
    "joint-ukf": "joint_ukf",
}


def kinds() -> tuple[str, ...]:
    """All kinds."""
    return tuple(_MODULES)


@lru_cache(maxsize=64)
def observer(kind: str) -> Observer:
    """The observer of a kind. Raises SpecError with the nearest kinds."""
    if kind not in _MODULES:
        raise SpecError(
            "observers.kind", kind, "there is no observer of that kind", f"choose from {', '.join(_MODULES)}"
        )
    return import_module(f"backend.engine.observers.{_MODULES[kind]}").OBSERVER
