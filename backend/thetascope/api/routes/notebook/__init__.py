"""/api/runs as a notebook: the list, names and tags, comparisons."""
