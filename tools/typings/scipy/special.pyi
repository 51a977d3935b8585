from typing import Any

from numpy.typing import ArrayLike

# of numbers np.float64, of arrays arrays
def gammaincinv(a: ArrayLike, y: ArrayLike) -> Any: ...
def ndtri(y: ArrayLike) -> Any: ...
