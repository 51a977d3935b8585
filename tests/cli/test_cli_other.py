"""`thetascope list`, `check` and the start of the program."""

import gc
import json
import subprocess
import sys

import pytest

import thetascope
from tests.cli.conftest import ROOT
from tests.runs.samples import PLANT
from thetascope.process_settings import BY_DEFAULT, ONE_THREAD


def test_version_is_that_of_the_package(call):
    """`thetascope --version` prints the name and the version of the package."""
    assert call("--version") == (0, f"thetascope {thetascope.__version__}\n", "")


def test_list_names_the_experiments_and_plants_of_the_library(call):
    """Each has its title."""
    code, shown, _ = call("list")
    words = shown.split()
    assert code == 0
    assert {"zhao-2012", "shen-hu-2015", "reduced-order-mimo", "zhou-tan-2012", "dts200", "dc-motor"} <= set(words)


def test_check_describes_a_plant_file(call, tmp_path):
    """Sizes, Φ and Ψ, and the observers that can be built for it."""
    (tmp_path / "p.json").write_text(json.dumps(PLANT))
    code, shown, _ = call("check", "p.json")
    lines = [line.split() for line in shown.splitlines()]
    assert code == 0 and "1 state, 1 input, 1 output, 1 channel" in shown
    assert ["Φ", "gain"] in lines and ["x", "u"] in lines and ["y", "0"] in lines
    assert shown.index("adaptive-kalman") < shown.index("cannot") < shown.index("sandwich-nonsmooth")


YAML = """id: mine
states:
  - {name: x, domain: [0, null]}
outputs:
  - {name: y, expression: x}
parameters: [{name: a, value: 1}]
dynamics:
  x: "-a*x + a"
"""


@pytest.mark.parametrize(
    ("old", "new", "place", "under"),
    [
        ("-a*x + a", "-a*x + b", "p.yaml:8:14: dynamics.x", "b"),
        ("-a*x + a", "-a*x + a.real", "p.yaml:8:14: dynamics.x", "a.real"),
        ("-a*x + a", "-a*x + 9**9**9", "p.yaml:8:", "9"),
        ("expression: x", "expression: z", "p.yaml:5:27: outputs[0].expression", "z"),
        ("dynamics", "dynamiks", "p.yaml:8:3: dynamiks", "x"),
        ("value: 1", "value: one", "p.yaml:6:31: parameters[0].value", "one"),
        ("id: mine", "id: &a mine", "p.yaml:1:5: anchors", None),
    ],
)
def test_check_points_at_the_error_in_the_text(call, tmp_path, old, new, place, under):
    """Line and column of the file, and a mark below the word."""
    (tmp_path / "p.yaml").write_text(YAML.replace(old, new))
    code, _, error = call("check", "p.yaml")
    assert code == 1 and place in error
    if under:
        lines = error.splitlines()
        mark = next(i for i, line in enumerate(lines) if line.strip() == "^")
        assert lines[mark - 1][lines[mark].index("^") :].startswith(under)


def loaded(arguments: list[str], heavy: set[str]) -> set[str]:
    """Return which modules a command has loaded when it ends successfully, in a separate process, and "threads" if that
    process has more than one."""
    probe = (
        "import os, sys, thetascope.cli.main\n"
        f"try: code = thetascope.cli.main.main({arguments})\n"
        "except SystemExit as leaving: code = leaving.code\n"
        "threads = len(os.listdir('/proc/self/task')) if sys.platform == 'linux' else 1\n"
        f"assert not code\nprint('LOADED', *({heavy} & set(sys.modules)), *['threads'] * (threads > 1))"
    )
    done = subprocess.run(
        [sys.executable, "-c", probe], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return set(done.stdout.rpartition("LOADED")[2].split())


def test_help_answers_without_loading_the_engine():
    """It is printed immediately."""
    heavy = {"numpy", "fastapi", "sympy", "pydantic", "plotly", "yaml"}
    assert loaded(["--help"], heavy) == set()
    assert "pydantic" in loaded(["list"], heavy)


def test_a_run_does_not_load_the_web_service_or_plotly_and_uses_one_thread(monkeypatch):
    """Unused packages do not delay the start of the command line, and no thread of linear algebra waits by spinning."""
    for name in ONE_THREAD:
        monkeypatch.delenv(name, raising=False)
    heavy = {"fastapi", "starlette", "uvicorn", "plotly", "llvmlite"}
    assert loaded(["run", "shen-hu-2015", "--set", "horizon=1", "--quiet"], heavy) == {"llvmlite"}


def test_garbage_is_collected_rarely_until_a_service_has_started(call, monkeypatch):
    """Imports are not searched again and again; a collection during a live session would be too long otherwise."""
    usual, at_start = gc.get_threshold(), []
    monkeypatch.setattr("thetascope.server.app.serve", lambda *_: at_start.append(gc.get_threshold()))
    gc.set_threshold(*BY_DEFAULT)
    call("--version")
    rare = gc.get_threshold()
    assert call("serve")[0] == 0
    gc.set_threshold(*usual)
    assert rare > BY_DEFAULT and at_start == [BY_DEFAULT]


def test_serve_reports_an_unusable_store(process, tmp_path, monkeypatch):
    """Before it listens."""
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("THETASCOPE_DATA", str(tmp_path / "file"))
    found = process("serve", "--port", "0")
    assert found.returncode == 1 and "THETASCOPE_DATA" in found.stderr and "Traceback" not in found.stderr


def test_a_pipe_that_closes_early_is_not_an_error():
    """`thetascope list | head -1`."""
    shell = f"{sys.executable} -m thetascope.cli.main list | head -1"
    done = subprocess.run(shell, shell=True, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout.startswith("EXPERIMENT") and "Traceback" not in done.stderr and "BrokenPipe" not in done.stderr
