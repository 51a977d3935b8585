"""The kinds of observers, in the order in which they are offered. Adding one is one file and one line here."""

from functools import lru_cache
from importlib import import_module

from thetascope.engine.errors import SpecError
from thetascope.engine.observers.support.declaration import Observer

_MODULES = {
    "high-gain": "papers.high_gain",
    "zhao-adaptive": "papers.zhao_adaptive",
    "nonsmooth-adaptive": "papers.nonsmooth_adaptive",
    "linear-adaptive": "papers.linear_adaptive",
    "reduced-order": "papers.reduced_order",
    "full-order": "papers.full_order",
    "sandwich-nonsmooth": "papers.sandwich_nonsmooth",
    "sandwich-conventional": "papers.sandwich_conventional",
    "adaptive-kalman": "kalman.adaptive_kalman",
    "adaptive-kalman-discrete": "kalman.adaptive_kalman_discrete",
    "joint-ekf": "kalman.joint_ekf",
    "joint-ukf": "kalman.joint_ukf",
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
    return import_module(f"thetascope.engine.observers.{_MODULES[kind]}").OBSERVER
