"""Write docs/dependencies.md, the licences of all installed dependencies: `python -m tools.list_licences`.

Names and versions come from requirements.txt, licences from the metadata of the installed packages; those of the
packages from npm, from which the page's editor is made, from package-lock.json.
"""

import json
import re
import sys
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / "docs" / "dependencies.md"
_PIN = re.compile(r"^([A-Za-z0-9._-]+)==(\S+)", re.MULTILINE)
_CLASSIFIER = "License :: OSI Approved :: "
_LONGEST = 60  # some packages have the whole text of their licence as its name


def pinned() -> dict[str, str]:
    """Return the versions in requirements.txt by name."""
    return dict(_PIN.findall((ROOT / "requirements.txt").read_text(encoding="utf-8")))


def licence(package: str) -> str:
    """Return the licence of an installed package: its SPDX expression, its classifiers, or its own short name."""
    try:
        data = metadata(package)
    except PackageNotFoundError:  # of another system: as it was written there
        return dict(re.findall(r"^\| (\S+) \| \S+ \| (.+) \|$", FILE.read_text(encoding="utf-8"), re.MULTILINE))[
            package
        ]
    classified = [
        name.removeprefix(_CLASSIFIER) for name in data.get_all("Classifier", []) if name.startswith(_CLASSIFIER)
    ]
    own = data.get("License") or ""
    if "Permission is hereby granted, free of charge" in own:  # the whole text, which has no name
        return "MIT License"
    short = own if 0 < len(own) <= _LONGEST and "\n" not in own else ""
    return data.get("License-Expression") or ", ".join(classified) or short or "not stated"


def bundled() -> dict[str, tuple[str, str]]:
    """Return version and licence of the packages from npm that are part of the page, by name."""
    packages = json.loads((ROOT / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    return {
        path.removeprefix("node_modules/"): (entry["version"], entry["license"])
        for path, entry in sorted(packages.items())
        if path and not entry.get("dev") and not entry.get("optional") and not path.endswith("/esbuild")
    }


def page() -> str:
    """Return the text of docs/dependencies.md."""
    rows = [f"| {name} | {version} | {licence(name)} |" for name, version in sorted(pinned().items())]
    head = [
        "# Dependencies and their licences",
        "",
        "Installed by `make run` and in the container. Thetascope itself is under the MIT licence. "
        "`python -m tools.list_licences` writes",
        "this page; the tools for tests are in `requirements-dev.txt` and `package.json`.",
        "",
        "| package | version | licence |",
        "|---|---|---|",
    ]
    npm = ["", "From npm, in the workshop's editor:", "", *head[-2:]]
    npm += [f"| {name} | {version} | {licence} |" for name, (version, licence) in bundled().items()]
    return "\n".join([*head, *rows, *npm]) + "\n"


if __name__ == "__main__":
    FILE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{FILE.relative_to(ROOT)}\n")
