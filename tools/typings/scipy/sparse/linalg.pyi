from typing import Literal

import numpy as np

class ArpackError(RuntimeError): ...

class ArpackNoConvergence(ArpackError):
    eigenvalues: np.ndarray

def eigs(
    A: np.ndarray,
    k: int = 6,
    *,
    which: Literal["LM", "SM", "LR", "SR", "LI", "SI"] = "LM",
    v0: np.ndarray | None = None,
    maxiter: int | None = None,
    tol: float = 0,
    return_eigenvectors: Literal[False],
) -> np.ndarray: ...
