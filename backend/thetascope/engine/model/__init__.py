"""A plant as mathematics, and the form of a run's result."""
