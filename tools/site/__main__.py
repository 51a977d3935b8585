"""Build the documentation as a site: `python -m tools.site [FOLDER]`, by default build/site.

A broken link or an unknown page is an error. The site needs no server and no internet: open index.html.
"""

import sys
from pathlib import Path

from mkdocs.__main__ import cli

_FOLDER = Path(sys.argv[1] if len(sys.argv) > 1 else "build/site").resolve()
_CONFIG = Path(__file__).with_name("mkdocs.yml")

cli(["build", "--strict", "--config-file", str(_CONFIG), "--site-dir", str(_FOLDER)])
