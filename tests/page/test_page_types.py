"""The page's types hold, and those of the service are the service's own."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tools.page_types import FILE, page

ROOT = Path(__file__).parents[2]
NODE = Path(sys.executable).with_name("node.exe" if sys.platform == "win32" else "node")
SOURCES = [
    *(ROOT / "frontend").rglob("*.js"),
    *(ROOT / "frontend").rglob("*.d.ts"),
    *Path(__file__).parent.glob("*.js"),
]


@pytest.mark.parametrize("project", [".", "tests/page"])
def test_there_are_no_type_errors(project: str):
    """`tsc` in strict mode accepts every module of the page and of the report, and the page's unit tests."""
    tsc = ROOT / "node_modules" / "typescript" / "bin" / "tsc"
    command = [NODE, tsc, "--project", project, "--pretty", "false"]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_the_types_of_the_service_are_current():
    """`python -m tools.page_types` would write the same file."""
    assert FILE.read_text(encoding="utf-8") == page()


def test_no_check_of_types_is_switched_off():
    """No module says `any`, `@ts-nocheck` or `@ts-ignore`."""
    loose = re.compile(r"@ts-(nocheck|ignore|expect-error)|[{<(|:,?]\s*any(\[\])?\s*[}>)|,;=]")
    lines = {
        f"{path.relative_to(ROOT)}:{number}": line
        for path in SOURCES
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
    }
    assert {place for place, line in lines.items() if loose.search(line)} == set()
