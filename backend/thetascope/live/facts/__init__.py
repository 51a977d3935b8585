"""The facts of a live session: what acts and what was found at the row that is shown, and observers over a window."""
