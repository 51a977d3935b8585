"""Analyses of a spec: plant check, seed trial, diagnosis of a record, observability, facts."""
