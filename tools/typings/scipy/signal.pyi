import numpy as np
from numpy.typing import ArrayLike

def lfilter(b: ArrayLike, a: ArrayLike, x: ArrayLike) -> np.ndarray: ...
