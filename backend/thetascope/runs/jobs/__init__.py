"""Runs that are active, in memory and in the store."""
