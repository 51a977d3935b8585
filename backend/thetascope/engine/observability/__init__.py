"""Observability and identifiability of states and faults."""
