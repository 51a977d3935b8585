"""Running an experiment to its horizon: stages, columns, checks."""
