"""Thetascope: observers that estimate faults. Numerics, library, store, service, page and command line."""

from importlib import import_module
from typing import TYPE_CHECKING

__version__ = "0.1.0"

__all__ = ["Client", "__version__", "diagnose", "linearise", "linearise_observer", "run", "to_control"]

if TYPE_CHECKING:
    from thetascope.client import Client as Client
    from thetascope.in_process import diagnose as diagnose
    from thetascope.in_process import run as run
    from thetascope.linear import linearise as linearise
    from thetascope.linear import linearise_observer as linearise_observer
    from thetascope.linear import to_control as to_control

_MODULES = {
    "Client": "thetascope.client",
    **dict.fromkeys(("diagnose", "run"), "thetascope.in_process"),
    **dict.fromkeys(("linearise", "linearise_observer", "to_control"), "thetascope.linear"),
}


def __getattr__(name: str) -> object:
    """Import a name when it is first used: `thetascope --help` should not wait for NumPy."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)
