"""Numerical loops over arrays, written in a subset of Python and compiled to machine code."""
