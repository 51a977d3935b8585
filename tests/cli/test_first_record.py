"""docs/first-record.md: its commands run as they stand, and print what it shows."""

import re
import shlex
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "first-record.md"


def test_the_first_record_is_diagnosed_as_the_page_shows(call):
    """Every command gives its exit code, and every line of output that the page shows is printed."""
    text = PAGE.read_text(encoding="utf-8")
    printed = ""
    for block in re.findall(r"```sh\n(.*?)```", text, flags=re.DOTALL):
        for line in block.splitlines():
            fails = line.endswith(" || true")
            code, shown, error = call(*shlex.split(line.removesuffix(" || true"))[1:])
            assert code == (1 if fails else 0), f"{line}\n{shown}{error}"
            printed += shown
    lines = {line.rstrip() for line in printed.splitlines()}
    shown = [line[4:].rstrip() for line in text.splitlines() if line.startswith("    ") and line.strip()]
    assert [line for line in shown if line not in lines] == []
    fitted = re.search(r"^A \[cm²\]\s+\S+\s+(\S+)\s+(\S+)", printed, flags=re.MULTILINE)
    assert fitted is not None and abs(float(fitted[1]) - 154) < 3 * float(fitted[2])


def test_the_page_names_the_fault_in_python_too():
    """The Python of the page runs."""
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    exec(compile(code, str(PAGE), "exec"), {})
