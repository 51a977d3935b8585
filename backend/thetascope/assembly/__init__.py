"""Build engine objects from schemas; only this package knows both."""

from thetascope.assembly.analyses.observer_catalogue import observer_kinds
from thetascope.assembly.analyses.plant_check import check_plant
from thetascope.assembly.build.prepare import Cost, Prepared, prepare

__all__ = ["Cost", "Prepared", "check_plant", "observer_kinds", "prepare"]
