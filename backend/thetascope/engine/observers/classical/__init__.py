"""Observers that fault diagnosis reaches for first, with gains designed at the plant's operating point."""
