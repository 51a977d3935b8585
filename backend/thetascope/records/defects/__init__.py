"""What is peculiar about a record: one module per kind of finding."""
