"""What the service reads and answers: runs, records, comparisons, sessions, lessons."""
