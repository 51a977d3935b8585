"""Residuals, measures and decisions on a finished result: pure NumPy above the engine."""
