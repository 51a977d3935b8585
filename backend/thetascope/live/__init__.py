"""Live sessions: commands in, rows and events out."""
