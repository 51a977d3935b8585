"""Set-up: installed packages are pinned, and the conditions for a new installation are correct."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tools import browser, environment, page_tools

ROOT = Path(__file__).parents[1]
CLUSTER = "requirements-cluster.txt"
"""What the image installs: the service, and Dask for its workers."""
PIN = re.compile(r"^([a-z0-9-]+)==([^ ;]+)( ; .+)? \\$")


def pins(file: str) -> dict[str, str]:
    """Return package → version of a requirements file; fail for a line that is not a pin, a hash or a comment."""
    found = {}
    for line in (ROOT / file).read_text().splitlines():
        if line.startswith(("    --hash=sha256:", "    #", "#")):
            continue
        match = PIN.match(line)
        assert match, f"{file}: {line}"
        found[match[1]] = match[2]
    return found


@pytest.mark.parametrize("file", [*environment.LEVELS.values(), CLUSTER])
def test_requirements_are_versions_with_hashes_and_nothing_else(file: str):
    """Each package has one exact version and hashes; no line names an index."""
    blocks = re.split(r"^(?=[a-z])", (ROOT / file).read_text(), flags=re.MULTILINE)[1:]
    assert len(pins(file)) == len(blocks) > 20
    assert all("--hash=sha256:" in block for block in blocks)


def test_each_level_contains_the_one_before_it_at_the_same_versions():
    """Developers and benchmarks use the versions of users."""
    run, dev, bench = (pins(file) for file in environment.LEVELS.values())
    assert run.items() <= dev.items() <= bench.items()
    assert run.items() <= pins(CLUSTER).items() <= dev.items()


def test_every_dependency_is_pinned():
    """Every dependency in pyproject.toml is in the requirements of its level."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    groups = project["dependency-groups"]
    required = {
        "run": project["project"]["dependencies"] + groups["build"],
        "dev": groups["dev"],
        "bench": groups["bench"],
    }
    for level, texts in required.items():
        names = {re.match(r"[\w-]+", text)[0] for text in texts}
        assert names <= set(pins(environment.LEVELS[level])), level


def checkout(folder: Path, monkeypatch) -> tuple[Path, Path]:
    """Let the set-up work in `folder` with copies of its files; return its Python and its note."""
    (folder / "tools" / "editor").mkdir(parents=True)
    for name in ("pyproject.toml", *environment.LEVELS.values(), *environment.PAGE_TOOLS):
        (folder / name).write_text((ROOT / name).read_text())
    python, note = folder / "python", folder / "installed"
    page_note = folder / "node_modules" / ".package-lock.json"
    bundle = folder / "codemirror.js"
    places = {"ROOT": folder, "PYTHON": python, "NOTE": note, "PAGE_NOTE": page_note, "BUNDLE": bundle}
    for name, value in places.items():
        monkeypatch.setattr(environment, name, value)
    return python, note


def test_an_environment_is_valid_only_for_its_requirements(tmp_path, monkeypatch):
    """A second set-up has nothing to do; a changed pin, another folder or a missing Python starts a new one."""
    python, note = checkout(tmp_path, monkeypatch)
    assert not environment.installed("run")
    python.symlink_to(sys.executable)
    note.write_text(environment.digest("run"))
    assert environment.installed("run")
    assert not environment.installed("dev")
    (tmp_path / "requirements.txt").write_text("numpy==1.0 \\\n    --hash=sha256:0\n")
    assert not environment.installed("run")
    note.write_text(environment.digest("run"))
    python.unlink()
    python.symlink_to(tmp_path / "gone")
    assert not environment.installed("run")


def test_packages_from_npm_are_installed_as_locked(tmp_path, monkeypatch):
    """Each level runs `npm ci`, users without the tools, and makes the editor; dev again after a lost node_modules."""
    python, _ = checkout(tmp_path, monkeypatch)
    python.symlink_to(sys.executable)
    commands: list[tuple[str, ...]] = []

    def start(*command: str) -> subprocess.Popen:
        commands.append(command)
        if "ci" in command:
            (tmp_path / "node_modules").mkdir(exist_ok=True)
            environment.PAGE_NOTE.write_text("{}")
        if "--bundle" in command:
            environment.BUNDLE.write_text("")
        return subprocess.Popen([sys.executable, "-c", ""])

    monkeypatch.setattr(environment, "start", start)
    monkeypatch.setattr(environment, "compile_tests", lambda: None)
    monkeypatch.setattr(environment, "create", lambda: ["pip"])
    environment.install("run")
    assert environment.installed("run")
    assert [c[-2:] for c in commands if "ci" in c] == [("--omit", "dev")]

    environment.install("dev")
    npm = [c for c in commands if "ci" in c][-1]
    assert npm[0] == str(environment.NPM) and "--ignore-scripts" in npm and "--omit" not in npm
    assert environment.installed("dev")
    for made in (environment.PAGE_NOTE, environment.BUNDLE):
        made.unlink()
        assert not environment.installed("dev")
        assert environment.installed("run")
        environment.install("dev")

    lock = tmp_path / "package-lock.json"
    lock.write_text(lock.read_text().replace("sha512-", "sha512-0", 1))
    assert not environment.installed("dev")
    assert not environment.installed("run")


def test_users_without_npm_get_the_page_without_its_editor(tmp_path, monkeypatch, capsys):
    """A failed `npm ci` is said, and does not keep the service from starting; developers get an error."""
    python, _ = checkout(tmp_path, monkeypatch)
    python.symlink_to(sys.executable)
    good, bad = script(tmp_path / "good", 0), script(tmp_path / "bad", 1)
    monkeypatch.setattr(environment, "NPM", bad)
    monkeypatch.setattr(environment, "create", lambda: [good])
    assert environment.main(["run"]) == 0
    assert "plain field" in capsys.readouterr().out and environment.installed("run")


@pytest.mark.parametrize("program", ["pip", "npm"])
def test_a_failed_installation_is_reported_and_not_recorded(program, tmp_path, monkeypatch, capsys):
    """If pip or npm fails, the set-up names the command, and the next one starts again."""
    python, note = checkout(tmp_path, monkeypatch)
    python.symlink_to(sys.executable)
    good, bad = script(tmp_path / "good", 0), script(tmp_path / "bad", 1)
    monkeypatch.setattr(environment, "NPM", bad if program == "npm" else good)
    monkeypatch.setattr(environment, "compile_tests", lambda: None)
    monkeypatch.setattr(environment, "create", lambda: [bad if program == "pip" else good])
    assert environment.main(["dev"]) == 1
    assert f"this failed: {bad} {'ci' if program == 'npm' else 'install'}" in capsys.readouterr().err
    assert not note.exists()


def test_tools_from_npm_are_versions_with_hashes():
    """package.json has exact versions, which the lock contains with hashes and without the address of a registry."""
    package, lock = (json.loads((ROOT / name).read_text()) for name in ("package.json", "package-lock.json"))
    locked = {name.removeprefix("node_modules/"): entry for name, entry in lock["packages"].items() if name}
    assert package["devDependencies"].keys() >= page_tools.PROGRAMS.keys() - {"tsc"}
    for name, version in (package["devDependencies"] | package["dependencies"]).items():
        assert locked[name]["version"] == version
    for name, entry in locked.items():
        assert entry["integrity"].startswith("sha512-"), name
        assert "resolved" not in entry, name


def test_the_editor_is_made_of_packages_that_users_install():
    """Every import of the bundle's source is a dependency, and none of these is left over."""
    source = (ROOT / "tools" / "editor" / "codemirror.js").read_text()
    used = set(re.findall(r"from '([^']+)'", source))
    assert used | {"esbuild"} == set(json.loads((ROOT / "package.json").read_text())["dependencies"])


@pytest.mark.parametrize("tool", page_tools.PROGRAMS)
def test_every_tool_from_npm_starts(tool: str):
    """Each tool runs with the environment's node and prints the version that package.json names."""
    answer = subprocess.run(page_tools.command(tool, "--version"), capture_output=True, text=True, check=True)
    package = "typescript" if tool == "tsc" else tool
    assert json.loads((ROOT / "package.json").read_text())["devDependencies"][package] in answer.stdout


def test_a_python_without_venv_is_refused_with_the_remedy(tmp_path, monkeypatch, capsys):
    """Debian's Python without python3-venv: the package is named, without a traceback."""
    bare = tmp_path / "bare"  # a real environment without pip, as `python -m venv` leaves it there
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", bare], check=True)
    found = environment.importlib.util.find_spec
    monkeypatch.setattr(
        environment.importlib.util, "find_spec", lambda name: None if name == "ensurepip" else found(name)
    )
    monkeypatch.setattr(environment.sys, "executable", str(bare / "bin" / "python"))
    monkeypatch.setattr(environment, "VENV", tmp_path / "venv")
    monkeypatch.setattr(environment, "PYTHON", tmp_path / "venv" / "bin" / "python")
    monkeypatch.setattr(environment, "NOTE", tmp_path / "venv" / "installed")
    assert environment.main(["run"]) == 1
    assert "apt install python3-venv" in capsys.readouterr().err


def script(path: Path, code: int) -> str:
    path.write_text(f"#!/bin/sh\nexit {code}\n")
    path.chmod(0o755)
    return str(path)


def test_a_browser_that_does_not_start_is_skipped(tmp_path, monkeypatch):
    """Of two on the path the working one is used; a named one must work."""
    broken, working = script(tmp_path / "chromium", 1), script(tmp_path / "google-chrome", 0)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv(browser.VARIABLE, raising=False)
    assert browser.find() == working
    monkeypatch.setenv(browser.VARIABLE, broken)
    assert browser.find() is None
    assert browser.fetch() is None


def test_the_command_is_installed():
    """`thetascope` is in the environment and has its commands."""
    program = Path(sys.executable).parent / "thetascope"
    answer = subprocess.run([program, "--help"], capture_output=True, text=True, check=True, env=dict(os.environ))
    assert {"serve", "run", "list", "check"} <= set(re.findall(r"[a-z]+", answer.stdout))


def test_the_image_may_copy_what_its_file_copies():
    """Docker's context leaves out all but what `.dockerignore` names: each source of a COPY is among that."""
    kept = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    copies = re.findall(r"^COPY (?!--from)(.+)$", (ROOT / "Dockerfile").read_text(), re.MULTILINE)
    wanted = {source for line in copies for source in line.split()[:-1]}
    assert len(wanted) > 8 and wanted <= kept
    assert all((ROOT / source).exists() for source in wanted)
