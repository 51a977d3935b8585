"""The notebook of runs: lists, names and tags, removal, comparison."""
