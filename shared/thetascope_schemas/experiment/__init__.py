"""Schemas of an experiment and its parts: plant, signals, faults, observers, commands, figures, diagnosis."""
