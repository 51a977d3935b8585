"""Lessons that clients have made."""
