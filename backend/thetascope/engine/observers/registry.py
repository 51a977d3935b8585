"""The kinds of observers, in the order in which they are offered. Adding one is one file and one line here."""

from difflib import get_close_matches
from functools import lru_cache
from importlib import import_module

from thetascope.engine.errors import SpecError
from thetascope.engine.observers.support.declaration import Observer
from thetascope.messages import Message

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
    "proportional-integral": "classical.proportional_integral",
    "extended-state": "classical.extended_state",
    "sliding-mode": "classical.sliding_mode",
    "unknown-input": "classical.unknown_input",
    "drem": "classical.drem",
    "parity": "classical.parity",
}


def kinds() -> tuple[str, ...]:
    """Return the identifiers of all kinds."""
    return tuple(_MODULES)


def suggestion(kind: str) -> Message:
    """Return the remedy for a kind that is not known: the nearest kinds, or else all."""
    near = get_close_matches(kind, _MODULES, n=3, cutoff=0.6)
    return Message("suggest.near", names=near) if near else Message("suggest.all", names=tuple(_MODULES))


@lru_cache(maxsize=64)
def observer(kind: str) -> Observer:
    """Return the observer of a kind. Raises SpecError with the nearest kinds."""
    if kind not in _MODULES:
        raise SpecError("observers.kind", kind, Message("observer.kind.unknown"), suggestion(kind))
    return import_module(f"thetascope.engine.observers.{_MODULES[kind]}").OBSERVER
