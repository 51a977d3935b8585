from enum import Enum
from typing import Any

import numpy as np

class SolverStatus(Enum):
    Solved = ...
    AlmostSolved = ...

class DefaultSettings:
    verbose: bool
    max_iter: int
    max_threads: int

class PSDTriangleConeT:
    def __init__(self, size: int) -> None: ...

class Solution:
    x: list[float]
    status: SolverStatus

class DefaultSolver:
    def __init__(
        self, P: Any, q: np.ndarray, A: Any, b: np.ndarray, cones: list[PSDTriangleConeT], settings: DefaultSettings
    ) -> None: ...
    def solve(self) -> Solution: ...
