"""Thetascope's service: numerics, library, store, web interface and command line."""
