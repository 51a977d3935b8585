"""Studies: an experiment repeated over what varies, in blocks that are computed anywhere and kept as they arrive."""
