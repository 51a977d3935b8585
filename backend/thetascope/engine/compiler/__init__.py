"""Compilation of a System of equations to machine code."""
