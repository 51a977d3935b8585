"""The run that the tests of figures draw, for the tests of reports."""

from tests.figures.conftest import experiment, plant, result

__all__ = ["experiment", "plant", "result"]
