"""Observers, one file each. support/declaration.py describes the contents of a file,
support/draft.py the form of its equations."""
