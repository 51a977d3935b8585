"""The version of the numbers: what, besides its spec, a result depends on."""

import hashlib
from functools import cache
from pathlib import Path

import numpy as np

_BACKEND = Path(__file__).parent.parent


@cache
def engine_version() -> str:
    """Hash of the engine's and the assembly's source and of NumPy's version.

    Results are stored under it, so that a store never answers with numbers that this program would not compute.
    """
    digest = hashlib.sha256(np.__version__.encode())
    for path in sorted([*(_BACKEND / "assembly").rglob("*.py"), *(_BACKEND / "engine").rglob("*.py")]):
        if path.exists():
            digest.update(path.relative_to(_BACKEND).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
