"""A Kalman filter along recorded rows: unequal intervals, missing cells, coloured noise, and faults of any course."""
