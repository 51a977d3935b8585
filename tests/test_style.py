"""Style: ruff's rules, and the format of ruff and Prettier."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tools import page_tools

ROOT = Path(__file__).parents[1]
RUFF = str(Path(sys.executable).parent / "ruff")
CHECKS = {
    "ruff check": [RUFF, "check", "--no-cache", "--output-format", "concise", "."],
    "ruff format": [RUFF, "format", "--no-cache", "--check", "."],
    "prettier": page_tools.command("prettier", "--check", "--log-level", "warn", "."),
}


@pytest.mark.parametrize("check", CHECKS)
def test_files_are_formatted(check: str):
    """Each checker finds nothing; `make lint` prints the same, and `ruff format` or `prettier --write` formats."""
    answer = subprocess.run(CHECKS[check], cwd=ROOT, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_every_test_states_its_claim():
    """Each test function has a docstring with the claim that it checks."""
    silent = [
        f"{path.relative_to(ROOT)}: {node.name}"
        for path in sorted((ROOT / "tests").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name.startswith("test_")
        if ast.get_docstring(node) is None
    ]
    assert silent == []
