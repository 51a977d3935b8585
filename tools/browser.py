"""Find a Chromium for the browser tests, or install one, and print its path.

Candidates in order: the one that THETASCOPE_BROWSER names, an installed one, Playwright's, Playwright's after
downloading it, and Debian's package if this runs as root on Debian. A browser that does not start is skipped.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

VARIABLE = "THETASCOPE_BROWSER"
#: The headless shell first: the same engine without a browser's own window, at two thirds of the processor time.
NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
MAC = tuple(Path(f"/Applications/{name}.app/Contents/MacOS/{name}") for name in ("Chromium", "Google Chrome"))


def main() -> int:
    """Print the path of a browser that starts; all other output goes to standard error."""
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
    """Return an installed browser. If the variable names one, return only that one, so that a typing error shows."""
    named = os.environ.get(VARIABLE)
    if named:
        return named if starts(named) else None
    candidates = [shutil.which(name) for name in NAMES] + [str(path) for path in MAC if path.exists()]
    return next((path for path in [*candidates, own()] if path and starts(path)), None)


def own() -> str | None:
    """Return the path at which Playwright stores its browser, whether or not it exists."""
    code = "from playwright.sync_api import sync_playwright as p\nwith p() as a: print(a.chromium.executable_path)"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    path = answer.stdout.strip()
    return path if path and Path(path).exists() else None


def fetch() -> str | None:
    """Download a browser and return its path; None if that fails."""
    if os.environ.get(VARIABLE):
        return None
    run(sys.executable, "-m", "playwright", "install", "chromium")
    path = own()
    if path and starts(path):
        return path
    if shutil.which("apt-get") and os.geteuid() == 0:
        run("apt-get", "update")
        run("apt-get", "install", "-y", "--no-install-recommends", "chromium-headless-shell", "fonts-dejavu-core")
    return find()


def run(*command: str) -> None:
    """Run a command with its output on standard error; success is tested by starting the browser afterwards."""
    print(f"browser: {' '.join(command)}", file=sys.stderr, flush=True)
    subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=sys.stderr,
        check=False,
        env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
    )


def starts(path: str) -> bool:
    """Return whether the browser runs at all: Ubuntu's package, for example, only prints how to install a snap."""
    try:
        return subprocess.run([path, "--version"], capture_output=True, timeout=30, check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


if __name__ == "__main__":
    sys.exit(main())
