"""What an experiment is made of, and the base of all schemas: plant, signals, faults, observers, commands, figures, diagnosis."""
