"""SymPy as an untyped library.

SymPy has no stubs. The types that pyright infers from its source are wrong where this project uses it most: calling a
`Function` gives `type[AppliedUndef]`, an argument of an expression is a `Basic` without arithmetic, an entry of a
matrix may be a list.
"""

from typing import Any

def __getattr__(name: str) -> Any: ...
