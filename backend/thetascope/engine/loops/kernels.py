"""Compiled loops: machine code for functions of declaration.py, called with NumPy arrays whose shapes are checked."""

import ctypes
import hashlib
import inspect
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from thetascope.engine.compiler.ir_builder import Writer, declarations
from thetascope.engine.compiler.jit import load, platform_key
from thetascope.engine.loops.declaration import Bundle, External, Loops, Parameter, size_of
from thetascope.engine.loops.translator import Translator

_C = {"int": ctypes.c_int64, "float": ctypes.c_double, "none": None}


class LoopKernel:
    """One compiled function. A call takes the arguments of the Python function by name, but no functions and sizes."""

    def __init__(self, source: Loops, engine, sizes: Mapping[str, int]):
        self._sizes, self._source = dict(sizes), source
        self._engine = engine  # the machine code lives as long as its engine
        passed = []
        for p in source.parameters:
            passed += [_C[p.kind]] if p.kind in ("int", "float") else [ctypes.c_void_p] * len(p.shapes)
        self._call = ctypes.CFUNCTYPE(_C[source.result], *passed)(engine.get_function_address(source.name))

    def __call__(self, **values):
        """Run the function. Raises ValueError for an array of another shape, type or layout than declared."""
        given = self._source.parameters
        sizes = self._sizes | {p.name: int(values[p.name]) for p in given if p.kind == "int"}
        arguments = []
        for p in given:
            if p.kind == "int":
                arguments.append(sizes[p.name])
            elif p.kind == "float":
                arguments.append(float(values[p.name]))
            elif p.kind == "bundle":
                arguments += self._addresses(p, values[p.name], sizes)
            elif p.kind == "array":
                arguments.append(self._address(p.name, values[p.name], p.shapes[""], sizes))
        return self._call(*arguments)

    def _addresses(self, parameter: Parameter, bundle: Bundle, sizes: Mapping[str, int]) -> list[int]:
        """Return the addresses of the arrays of a bundle, which have the declared shapes."""
        key = tuple(sizes.items())
        known = bundle.addresses.get(key)
        if known is None:
            known = [
                self._address(f"{parameter.name}.{name}", getattr(bundle, name), shape, sizes)
                for name, shape in parameter.shapes.items()
            ]
            bundle.addresses[key] = known
        return known

    def _address(self, name: str, array: np.ndarray, declared: tuple[str, ...], sizes: Mapping[str, int]) -> int:
        """Return the address of an array that has the declared shape."""
        shape = tuple(size_of(s, sizes) for s in declared)
        if array.dtype != np.float64 or not array.flags.c_contiguous or array.shape != shape:
            needed = f"a contiguous float64 array of shape {shape}"
            raise ValueError(f"{self._source.name}: {name} must be {needed}, not {array.dtype} {array.shape}")
        return array.__array_interface__["data"][0]


def compile_loops(
    exported: Sequence[Loops],
    inner: Sequence[Loops],
    sizes: Mapping[str, int],
    externals: Mapping[str, External],
    text_of: Callable[[], Sequence[str]] = lambda: (),
    key: str = "",
) -> dict[str, LoopKernel]:
    """Return compiled functions by name.

    Args:
        exported: the functions to be called from Python.
        inner: functions that they call; each may call the ones before it.
        sizes: the values of `Sizes`, constants of the machine code.
        externals: functions of `text_of` by the name of the function parameter that they replace.
        text_of: writes the IR lines of the externals; not called if the machine code is cached.
        key: a hash of everything that `text_of` depends on.
    """
    every = [*inner, *exported]
    sources = [inspect.getsource(f.function) for f in every]
    identity = ("loops", sources, sorted(sizes.items()), sorted(externals), key, platform_key())
    digest = hashlib.sha256(repr(identity).encode()).hexdigest()

    def text() -> str:
        known: dict[str, Loops | External] = dict(externals)
        lines = list(text_of())
        for function in every:
            lines += Translator(function, sizes, known).lines(function in exported)
            known[function.name] = function
        declared, attributes = declarations(Writer(1), scalar=True)
        return "\n".join([*declared, *lines, *attributes])

    engine = load(digest, text)
    return {f.name: LoopKernel(f, engine, sizes) for f in exported}
