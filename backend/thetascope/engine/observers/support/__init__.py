"""Tools for writing an observer: the draft of its equations, defaults of gains, checks."""
