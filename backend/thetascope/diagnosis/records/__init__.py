"""Diagnose recorded rows: noise, does the model fit, which fault, since when, how large."""
