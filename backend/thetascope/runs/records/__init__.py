"""Uploaded records: their files, and for each owner a plant and a mapping."""
