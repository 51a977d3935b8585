"""Kalman-type observers, one file each."""
