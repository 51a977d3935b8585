"""Simulation of plant, measurement and observers, for one run or for many runs in SIMD lanes."""
