"""SymPy, imported on first use: cached programs do not need it, and its import takes longer than all others together.

Write ``from thetascope.engine.language.lazy_sympy import sympy`` and use ``sympy.Matrix`` as usual; likewise
``functions.Backlash`` for this project's own functions, which are SymPy classes.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sympy

    from thetascope.engine.language import numerical_functions as numerical
    from thetascope.engine.language import sympy_functions as functions
else:

    class _Lazy:
        """A proxy of a module, which is imported at the first attribute access."""

        def __init__(self, name: str):
            self._name = name

        def __getattr__(self, attribute: str) -> object:
            value = getattr(importlib.import_module(self._name), attribute)
            setattr(self, attribute, value)  # the next access finds it without this function
            return value

    sympy, functions = _Lazy("sympy"), _Lazy("thetascope.engine.language.sympy_functions")
    numerical = _Lazy("thetascope.engine.language.numerical_functions")

__all__ = ["functions", "numerical", "sympy"]
