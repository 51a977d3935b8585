"""The command that writes figures."""
