"""Canonical forms and structures that observers stand on."""
