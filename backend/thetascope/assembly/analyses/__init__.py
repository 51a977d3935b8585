"""What else is asked of a spec: a plant's check, many seeds, a record's diagnosis."""
