"""The page's pure modules, tested in node: every `*.test.js` beside this file, without a browser."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
NODE = Path(sys.executable).with_name("node.exe" if sys.platform == "win32" else "node")
FILES = sorted(path.name for path in HERE.glob("*.test.js"))


@pytest.mark.parametrize("name", FILES)
def test_module(name: str):
    """node's test runner accepts every claim of the file, and the file has some."""
    command = [NODE, "--test-reporter=tap", name]  # without --test, which would start a second process
    answer = subprocess.run(command, cwd=HERE, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert re.search(r"^# pass [1-9]", answer.stdout, re.MULTILINE)
