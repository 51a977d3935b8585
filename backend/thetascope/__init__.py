"""Thetascope's service: numerics, library, store, web interface and command line."""

from typing import TYPE_CHECKING

__version__ = "0.1.0"

__all__ = ["Client", "__version__"]

if TYPE_CHECKING:
    from thetascope.client import Client as Client


def __getattr__(name: str) -> object:
    """Return `Client` when it is first used: it needs NumPy, and `thetascope --help` should not wait for that."""
    if name == "Client":
        from thetascope.client import Client

        return Client
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
