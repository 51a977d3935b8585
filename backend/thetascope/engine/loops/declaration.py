"""Compilation of numerical loops to machine code: Python functions of a small subset become LLVM functions.

Filters and sums over the rows of a record are loops over matrices whose sizes are known when a plant is known. They are
written as plain Python functions over NumPy arrays, so that a test can run the same text without a compiler, and are
translated here:

- parameters: ``int`` and ``float`` numbers, NumPy arrays of float64 whose shapes `loops` names, `Bundle` objects with
  several arrays, `Sizes`, and functions;
- statements: assignments, ``for … in range``, ``while``, ``if``, ``break``, ``continue``, ``return`` of a number,
  calls of other such functions; ``name = empty(…)`` declares a local array of fixed size;
- expressions: arithmetic, comparisons, ``and``, ``or``, ``not``, elements ``a[i, j]``, rows ``a[i]`` as arguments, and
  ``sqrt``, ``abs``, ``min``, ``max``, ``isnan``, ``float``, ``int`` and those of the C library.

All `Sizes` are constants of the machine code. Products and sums may be fused (``contract``), no
other rounding changes: the results do not depend on how rows are divided over calls.
"""

import ast
import inspect
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from math import prod
from typing import ClassVar, get_type_hints

import numpy as np


def empty(*shape: int) -> np.ndarray:
    """Return a local array: of the stack in machine code, of NumPy when the text runs as Python."""
    return np.empty(shape)


class Sizes:
    """Sizes by name, as attributes."""

    def __init__(self, **sizes: int):
        self.__dict__.update(sizes)

    def __getattr__(self, name: str) -> int:
        raise AttributeError(f"no size {name!r}")


class Bundle:
    """Base of dataclasses whose fields are arrays: ``F: Annotated[np.ndarray, "rows n n"]``.

    The addresses of its arrays are kept from call to call, until a field is assigned anew.
    """

    addresses: ClassVar[dict[tuple, list[int]]]

    def __setattr__(self, name: str, value: np.ndarray) -> None:
        object.__setattr__(self, name, value)
        object.__setattr__(self, "addresses", {})

    @classmethod
    def shapes(cls) -> dict[str, tuple[str, ...]]:
        """Return the declared shape of each field."""
        hints = get_type_hints(cls, include_extras=True)
        return {f.name: tuple(hints[f.name].__metadata__[0].split()) for f in fields(cls)}  # type: ignore[arg-type]


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function: kind int, float, array, bundle, sizes or function, and the shapes of its arrays."""

    name: str
    kind: str
    shapes: dict[str, tuple[str, ...]]


@dataclass(frozen=True, eq=False)
class Loops:
    """A function that can be compiled."""

    function: Callable
    parameters: tuple[Parameter, ...]
    tree: ast.FunctionDef
    result: str

    @property
    def name(self) -> str:
        """Return the name of the function."""
        return self.function.__name__

    def __call__(self, *args):
        """Run the text as Python."""
        return self.function(*args)


def loops(**shapes: str) -> Callable[[Callable], Loops]:
    """Return a decorator for a function of the subset; ``shapes``: of its arrays, as in ``F="n n"``."""

    def decorate(function: Callable) -> Loops:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        assert isinstance(tree, ast.FunctionDef)
        hints = get_type_hints(function)
        parameters = tuple(_parameter(a.arg, hints.get(a.arg), shapes) for a in tree.args.args)
        result = {int: "int", float: "float"}.get(hints.get("return", None), "none")
        return Loops(function, parameters, tree, result)

    return decorate


def _parameter(name: str, hint: object, shapes: dict[str, str]) -> Parameter:
    """Return a parameter by its annotation."""
    if name in shapes:
        return Parameter(name, "array", {"": tuple(shapes[name].split())})
    if hint in (int, float):
        return Parameter(name, "int" if hint is int else "float", {})
    if hint is Sizes:
        return Parameter(name, "sizes", {})
    if isinstance(hint, type) and issubclass(hint, Bundle):
        return Parameter(name, "bundle", hint.shapes())
    return Parameter(name, "function", {})


@dataclass(frozen=True)
class External:
    """A function of the module that is written elsewhere, with pointers as arguments.

    ``numbers``: how many float arguments come before the pointers.
    """

    name: str
    numbers: int
    pointers: int


def size_of(text: str, sizes: Mapping[str, int]) -> int:
    """Return a declared size: a name, a number, or a sum or product of them."""
    for sign, combine in (("+", sum), ("*", prod)):
        if sign in text:
            return combine(size_of(part, sizes) for part in text.split(sign))
    return int(text) if text.isdigit() else sizes[text]
