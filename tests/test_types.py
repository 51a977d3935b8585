"""Types: pyright accepts the packages in its standard mode."""

import subprocess
from pathlib import Path

from tools import page_tools

ROOT = Path(__file__).parents[1]


def test_pyright_finds_no_error():
    """The settings in pyproject.toml hold for both packages; `make lint` prints the same."""
    command = page_tools.command("pyright", "--project", "pyproject.toml")
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stdout + answer.stderr
