"""What outputs can tell of states and faults, by the equations and along a run."""
