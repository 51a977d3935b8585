"""The facts of a live session: active faults and findings at the row that is shown,
and the comparison of observers over a window."""
