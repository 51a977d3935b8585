"""The types of the page and of the service agree."""

from tools.page_types import FILE, page


def test_the_types_of_the_service_are_current():
    """`python -m tools.page_types` would write the same file."""
    assert FILE.read_text(encoding="utf-8") == page()
