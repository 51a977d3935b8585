"""The notebook of runs: its lines, names and tags, and comparisons of runs."""
