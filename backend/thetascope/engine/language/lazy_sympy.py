"""SymPy, imported when it is first used: programs found in the cache need none of it, and it takes longer to import
than everything else together. Write ``from thetascope.engine.language.lazy_sympy import sympy``, and ``sympy.Matrix`` in the code;
likewise ``functions.Backlash`` for the project's own functions, which are SymPy classes.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sympy

    from thetascope.engine.language import sympy_functions as functions
else:

    class _Lazy:
        """Stands for a module; the first attribute that is asked for imports it."""

        def __init__(self, name: str):
            self._name = name

        def __getattr__(self, attribute: str) -> object:
            return getattr(importlib.import_module(self._name), attribute)

    sympy, functions = _Lazy("sympy"), _Lazy("thetascope.engine.language.sympy_functions")

__all__ = ["functions", "sympy"]
