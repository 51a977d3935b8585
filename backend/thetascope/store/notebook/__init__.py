"""The notebook of runs: facts by which they are found, names and tags of their owners, removal that can be undone."""
