"""Schemas → engine objects: the only place that knows both."""

from backend.assembly.catalogue import observer_kinds
from backend.assembly.check import check_plant
from backend.assembly.prepare import Cost, Prepared, prepare

__all__ = ["Cost", "Prepared", "check_plant", "observer_kinds", "prepare"]
