from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

def block_diag(*arrs: ArrayLike) -> np.ndarray: ...
def matrix_balance(A: ArrayLike, permute: bool = True, scale: bool = True) -> tuple[np.ndarray, np.ndarray]: ...
def schur(
    a: ArrayLike, *, sort: Callable[..., Any] | Literal["lhp", "rhp", "iuc", "ouc"]
) -> tuple[np.ndarray, np.ndarray, int]: ...
