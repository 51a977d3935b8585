"""Settings of all tests: property-based tests are reproducible and keep no files."""

import gc
import os

from hypothesis import HealthCheck, settings

from thetascope.process_settings import collect_rarely, use_one_thread

settings.register_profile(
    "project", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("project")

use_one_thread()
os.environ.setdefault("THETASCOPE_PREPARE", "0")  # services that tests start compile what they are asked for
# On a busy machine an honest computation takes longer than a service allows by default.
os.environ.setdefault("THETASCOPE_JOB_SECONDS", "300")
os.environ.setdefault("THETASCOPE_JOB_CPU", "300")

#: The longest tests. Started first, they do not keep one worker busy after the others have ended.
FIRST = ("tests/test_types.py", "tests/test_docs.py", "tests/browser/")


def pytest_collection_modifyitems(items: list) -> None:
    """Put the longest tests first; the others keep their order."""
    items.sort(key=lambda item: next((i for i, path in enumerate(FIRST) if item.nodeid.startswith(path)), len(FIRST)))


def pytest_collection_finish() -> None:
    """Let garbage collections be rare, and leave out what was imported and collected."""
    gc.freeze()
    collect_rarely()
