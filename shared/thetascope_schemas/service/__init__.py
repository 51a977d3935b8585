"""Schemas of the service's requests and answers: runs, records, comparisons, sessions, lessons."""
