"""The mathematical model of a plant, and the result of a run."""
