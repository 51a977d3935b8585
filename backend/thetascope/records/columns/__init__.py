"""From columns to quantities: names, units, times, and the mapping to a plant."""
