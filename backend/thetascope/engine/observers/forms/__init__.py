"""Canonical forms and structural conditions on which observers are based."""
