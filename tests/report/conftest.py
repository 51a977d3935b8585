"""The run of the tests of figures, for the tests of reports."""

from tests.figures.conftest import experiment, plant, result

__all__ = ["experiment", "plant", "result"]
