"""From tests to named faults: candidates, fits, decisions, revisions."""
