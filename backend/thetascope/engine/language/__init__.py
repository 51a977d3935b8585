"""The language of equations: text → checked tree → SymPy."""
