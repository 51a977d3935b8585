"""The diagnosis of a finished run, as plain data."""
