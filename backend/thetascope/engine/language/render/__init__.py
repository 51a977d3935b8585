"""Rendering of equations as MathML."""
