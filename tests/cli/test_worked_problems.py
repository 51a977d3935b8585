"""The worked problems under docs/: their commands and their Python run as they stand, and print what the page shows."""

import re
import shlex
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PROBLEMS = [DOCS / "first-record.md", *sorted((DOCS / "worked").glob("*.md"))]
# These are measured anew with every run, or belong to set-up, which the tests of the README cover.
NOT_PRINTED = ("make ",)


def shown_by(text: str) -> list[str]:
    """Return the lines of output that a page shows: the indented ones outside of fenced blocks and lists."""
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    lines = [line[4:].rstrip() for line in prose.splitlines() if line.startswith("    ") and line.strip()]
    return [line for line in lines if not line.startswith(NOT_PRINTED)]


@pytest.mark.parametrize("page", PROBLEMS, ids=lambda page: page.stem)
def test_a_worked_problem_prints_what_it_shows(page: Path, call, capsys):
    """In the page's order, each command gives its exit code; every line of output on the page is printed."""
    text = page.read_text(encoding="utf-8")
    printed = ""
    for language, block in re.findall(r"```(sh|python)\n(.*?)```", text, flags=re.DOTALL):
        if language == "python":
            exec(compile(block, str(page), "exec"), {})
            printed += capsys.readouterr().out
            continue
        for line in block.splitlines():
            fails = line.endswith(" || true")
            code, output, error = call(*shlex.split(line.removesuffix(" || true"))[1:])
            assert code == (1 if fails else 0), f"{line}\n{output}{error}"
            printed += output
    lines = {line.rstrip() for line in printed.splitlines()}
    assert [line for line in shown_by(text) if line not in lines] == []
    if page.stem == "first-record":  # step 5: the fit returns the cross-section within its interval
        fitted = re.search(r"^A \[cm²\]\s+\S+\s+(\S+)\s+(\S+)", printed, flags=re.MULTILINE)
        assert fitted is not None and abs(float(fitted[1]) - 154) < 3 * float(fitted[2])


def test_every_page_shows_output_or_says_what_to_do():
    """A page whose blocks the pattern misses would pass unseen: each has commands or a plan."""
    blocks = {page.stem: len(re.findall(r"```(?:sh|python)\n", page.read_text(encoding="utf-8"))) for page in PROBLEMS}
    assert {name for name, count in blocks.items() if not count} == {"class"} and len(blocks) == 5
