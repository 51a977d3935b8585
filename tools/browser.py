"""Find a Chromium for the browser tests, or get one, and print its path.

In this order: the one that THETASCOPE_BROWSER names, one that is installed, Playwright's own, Playwright's own after
downloading it, Debian's package when this is root on Debian. One that does not start is passed over.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

VARIABLE = "THETASCOPE_BROWSER"
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
MAC = tuple(Path(f"/Applications/{name}.app/Contents/MacOS/{name}") for name in ("Chromium", "Google Chrome"))


def main() -> int:
    """Print the path of a browser that starts; everything else goes to standard error."""
    path = find() or fetch()
    if path is None:
        print(
            "browser: no Chromium found and none could be installed. Install it (Debian: apt install chromium; "
            f"elsewhere: python -m playwright install chromium) or set {VARIABLE} to its path.",
            file=sys.stderr,
        )
        return 1
    print(path)
    return 0


def find() -> str | None:
    """A browser that is here already. One that the variable names is taken or nothing: a typing error must show."""
    named = os.environ.get(VARIABLE)
    if named:
        return named if starts(named) else None
    found = [shutil.which(name) for name in NAMES] + [str(path) for path in MAC if path.exists()]
    return next((path for path in [*found, own()] if path and starts(path)), None)


def own() -> str | None:
    """Where Playwright keeps the browser that it downloads, whether or not it is there."""
    code = "from playwright.sync_api import sync_playwright as p\nwith p() as a: print(a.chromium.executable_path)"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    path = answer.stdout.strip()
    return path if path and Path(path).exists() else None


def fetch() -> str | None:
    """Download one."""
    if os.environ.get(VARIABLE):
        return None
    run(sys.executable, "-m", "playwright", "install", "chromium")
    path = own()
    if path and starts(path):
        return path
    if shutil.which("apt-get") and os.geteuid() == 0:
        run("apt-get", "update")
        run("apt-get", "install", "-y", "--no-install-recommends", "chromium", "fonts-dejavu-core")
    return find()


def run(*command: str) -> None:
    """Run a command, its output on standard error; whether it worked shows in whether the browser then starts."""
    print(f"browser: {' '.join(command)}", file=sys.stderr, flush=True)
    subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=sys.stderr,
        check=False,
        env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
    )


def starts(path: str) -> bool:
    """Whether it runs at all: Ubuntu's package, for one, is a script that only says how to install a snap."""
    try:
        return subprocess.run([path, "--version"], capture_output=True, timeout=30, check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


if __name__ == "__main__":
    sys.exit(main())
