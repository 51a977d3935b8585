"""Runs under way, in memory and in the store."""
