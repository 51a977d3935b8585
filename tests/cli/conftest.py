"""Call the command line: in this process, which is fast, or as a separate process."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from thetascope.cli.main import main

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files and the store belong to the test, and the language is English."""
    monkeypatch.setenv("THETASCOPE_DATA", str(tmp_path / "data"))
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def call(capsys: pytest.CaptureFixture) -> Callable[..., tuple[int, str, str]]:
    """Call the command line; return its exit code, output and error output."""

    def call_one(*arguments: str) -> tuple[int, str, str]:
        try:
            code = main(arguments)
        except SystemExit as leaving:  # argparse's way
            code = leaving.code
        shown = capsys.readouterr()
        return code, shown.out, shown.err

    return call_one


@pytest.fixture
def process(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess]:
    """Call it as a separate process."""

    def run_one(*arguments: str, **options: object) -> subprocess.CompletedProcess:
        command = [sys.executable, "-m", "thetascope.cli.main", *arguments]
        return subprocess.run(command, check=False, capture_output=True, text=True, timeout=300, **options)

    return run_one
