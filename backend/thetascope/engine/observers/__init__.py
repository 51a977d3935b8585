"""Observers, one file each. See base.py for what a file offers and draft.py for how equations are written down."""
