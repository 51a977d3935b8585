"""What all tests share: property-based tests are reproducible and keep no files."""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "project", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("project")
