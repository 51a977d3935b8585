"""Settings of all tests: property-based tests are reproducible and keep no files."""

import os

from hypothesis import HealthCheck, settings

settings.register_profile(
    "project", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("project")

os.environ.setdefault("THETASCOPE_PREPARE", "0")  # services that tests start compile what they are asked for
