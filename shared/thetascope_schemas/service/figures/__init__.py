"""Figures of a run as files."""
