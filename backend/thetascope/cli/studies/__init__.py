"""The command of studies."""
