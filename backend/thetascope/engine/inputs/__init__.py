"""Inputs of a run over time: signals, faults, noise, sampling, and the time grid."""
