"""Answers about plants that users write: the check of a text, and saved plants."""
