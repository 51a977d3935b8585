"""The detector of an experiment, and the monitor that runs it along rows."""
