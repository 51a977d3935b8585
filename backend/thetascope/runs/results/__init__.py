"""Values derived from a result: its summary, its comparison, the version of the numbers."""
