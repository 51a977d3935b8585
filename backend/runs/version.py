"""The version of the numbers: what, besides its spec, a result depends on."""

import hashlib
from functools import cache
from pathlib import Path

import numpy as np

_BACKEND = Path(__file__).parent.parent


@cache
def engine_version() -> str:
    """Hash of the source of engine, diagnosis and assembly, and of NumPy's version.

    Results are stored under it, so that a store never answers with numbers, or findings, that this program would not give.
    """
    digest = hashlib.sha256(np.__version__.encode())
    folders = (_BACKEND / name for name in ("assembly", "diagnosis", "engine"))
    for path in sorted(path for folder in folders for path in folder.rglob("*.py")):
        if path.exists():
            digest.update(path.relative_to(_BACKEND).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
