"""The version of the numbers: what, besides its spec, a result depends on."""

import hashlib
from functools import cache
from pathlib import Path

import numpy as np

from thetascope.engine.compiler.cache import digest_of

_PACKAGE = Path(__file__).parents[2]


@cache
def engine_version() -> str:
    """Hash of the source of engine, diagnosis and assembly, and of NumPy's version.

    Results are stored under it, so that a store never answers with numbers, or findings, that this program would not give.
    """
    folders = " ".join(digest_of(_PACKAGE / name) for name in ("assembly", "diagnosis", "engine"))
    return hashlib.sha256(f"{np.__version__} {folders}".encode()).hexdigest()[:16]
