"""Analyses of a spec: check of a plant, many seeds, diagnosis of a record, observability, facts."""
