"""What enters a run over time: signals, faults, noise, sampling, the time grid."""
