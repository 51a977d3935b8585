"""One reader per file format: bytes → `Table`. Every size is checked before memory is reserved for it."""
