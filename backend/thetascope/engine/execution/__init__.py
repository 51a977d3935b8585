"""An experiment run to its horizon: stages, columns, checks."""
