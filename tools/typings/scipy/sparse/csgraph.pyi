from typing import Literal

import numpy as np
from scipy.sparse import csr_matrix

def connected_components(
    csgraph: csr_matrix, directed: bool = True, connection: Literal["weak", "strong"] = "weak"
) -> tuple[int, np.ndarray]: ...
