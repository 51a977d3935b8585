"""The version of the numbers: everything besides the spec that a result depends on."""

import hashlib
from functools import cache
from pathlib import Path

import numpy as np

from thetascope.engine.compiler.cache import digest_of

_PACKAGE = Path(__file__).parents[2]


@cache
def engine_version() -> str:
    """Return a hash of the source of engine, diagnosis and assembly, and of NumPy's version.

    Results are stored under it, so that the store never returns numbers or findings of a different program.
    """
    folders = " ".join(digest_of(_PACKAGE / name) for name in ("assembly", "diagnosis", "engine"))
    return hashlib.sha256(f"{np.__version__} {folders}".encode()).hexdigest()[:16]
