"""Windowed likelihood-ratio tests and their thresholds."""
