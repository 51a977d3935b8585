"""Commands on recorded data: inspect, diagnose, fit, and hysteresis."""
