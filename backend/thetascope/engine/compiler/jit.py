"""Compilation of Programs to machine code with LLVM, and calls with NumPy arrays. Object files are cached on disk."""

import ctypes
import hashlib
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import llvmlite
import llvmlite.binding as llvm
import numpy as np

from thetascope.engine.compiler import cache
from thetascope.engine.compiler.codegen import Layout, emit, fits_inline
from thetascope.engine.compiler.codegen_implicit import emit_implicit
from thetascope.engine.compiler.system import Program

_lock = threading.Lock()  # one thread at a time uses LLVM's compiler; compiled kernels run in parallel
_SIGNATURE = ctypes.CFUNCTYPE(None, ctypes.c_int64, *[ctypes.c_void_p] * 14, ctypes.c_int64)
NEVER = np.int64(1) << 60  # `first` of a segment in which nothing is recorded


@dataclass(frozen=True)
class Segments:
    """Segments of equal steps: step k of segment i begins at ``t[i] + (index[i] + k)·h[i]`` seconds.

    Segment i has ``steps[i]`` steps; the first recorded row follows ``first[i]`` of them (NEVER: none).
    """

    steps: np.ndarray  # int64
    first: np.ndarray  # int64
    t: np.ndarray
    index: np.ndarray
    h: np.ndarray


@lru_cache(maxsize=1)
def _machine() -> llvm.TargetMachine:
    """Return LLVM's target machine for this processor."""
    return _target_machine(2)


@lru_cache(maxsize=1)
def _quick_machine() -> llvm.TargetMachine:
    """Return the target machine that generates code fast."""
    return _target_machine(0)


def _target_machine(level: int) -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=level
    )


@lru_cache(maxsize=1)
def platform_key() -> str:
    """Return a hash of the processor, the compiler and the engine's source: machine code depends on them, too."""
    _machine()
    cpu = (llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten(), llvmlite.__version__)
    return hashlib.sha256(repr((cpu, cache.package_digest())).encode()).hexdigest()


class Kernel:
    """A compiled Program. A call advances ``state`` in place."""

    def __init__(self, program: Program, layout: Layout):
        self.program, self.layout = program, layout
        key = hashlib.sha256(repr((program.digest, layout, platform_key())).encode()).hexdigest()
        # Optimising a large straight-line function takes long and gains nothing. One without states, which is evaluated
        # once a row and not at every stage of every step, is not worth the time of LLVM's slower code generator either.
        small = fits_inline(program, layout)
        generate = emit_implicit if layout.implicit else emit
        self._engine = load(key, lambda: generate(program, layout), small, quick=not small and not program.states)
        self._run, self._run_each = (_SIGNATURE(self._engine.get_function_address(n)) for n in ("run", "run_each"))

    def __call__(
        self,
        segments: Segments,
        state: np.ndarray,
        params: np.ndarray,
        every: int,
        out: np.ndarray,
        held: np.ndarray | None = None,
        staged: np.ndarray | None = None,
        lane_held: np.ndarray | None = None,
        lane_staged: np.ndarray | None = None,
        lane_params: np.ndarray | None = None,
        emitted: np.ndarray | None = None,
    ) -> None:
        """Advance ``state`` (states × lanes) through the segments, recording into ``out`` (rows × states × lanes).

        held: segments × names; staged: steps × stages × names; lane_* the same with lanes innermost;
        emitted: steps × stages × nodes × lanes. All float64 and C-contiguous.
        """

        def at(array: np.ndarray | None):
            """Return the address of an array."""
            # faster than array.ctypes.data: batches make many short calls
            return None if array is None else array.__array_interface__["data"][0]

        self._run(
            len(segments.steps),
            at(segments.steps),
            at(segments.first),
            at(segments.t),
            at(segments.index),
            at(segments.h),
            at(held),
            at(lane_held),
            at(staged),
            at(lane_staged),
            at(params),
            at(lane_params),
            at(state),
            at(out),
            at(emitted),
            every,
        )

    def advance_each(
        self,
        segments: Segments,
        states: np.ndarray,
        params: np.ndarray,
        held: np.ndarray,
        staged: np.ndarray,
        emitted: np.ndarray,
    ) -> None:
        """Advance each row of ``states`` (segments × states) through one segment; all segments have equally many steps.

        held, staged and emitted as for a call, for all segments together.
        """
        if not len(states):
            return
        arrays = (segments.steps, segments.first, segments.t, segments.index, segments.h, held, None, staged, None)
        arrays += (params, None, states, np.zeros(states.shape[1] or 1), emitted)
        assert all(a is None or a.flags.c_contiguous for a in arrays), "the kernel computes addresses of rows"
        places = [None if a is None else a.__array_interface__["data"][0] for a in arrays]
        self._run_each(len(states), *places, int(segments.steps[0]))


@lru_cache(maxsize=256)
def kernel(program: Program, layout: Layout) -> Kernel:
    """Return the kernel of a program and layout: from memory, else from the object cache, else compiled."""
    return Kernel(program, layout)


def load(key: str, text: Callable[[], str], optimised: bool = True, quick: bool = False) -> llvm.ExecutionEngine:
    """Return a loaded module: machine code from the object cache, else compiled from the IR text and stored there.

    ``quick``: compile fast instead of to fast code; the code rounds in the same way.
    """
    with cache.lock(key):
        code = cache.read("kernel", key)
        if code is None:
            source = text()
            with _lock:
                code = _object_code(source, optimised, quick)
            cache.write("kernel", key, code)
    with _lock:
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine_for_engine())
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return engine


def _object_code(text: str, optimised: bool, quick: bool) -> bytes:
    """Compile IR text to object code."""
    module = llvm.parse_assembly(text)
    if optimised:
        builder = llvm.create_pass_builder(_machine(), llvm.create_pipeline_tuning_options(speed_level=2))
        builder.getModulePassManager().run(module, builder)
    return (_quick_machine() if quick else _machine()).emit_object(module)


def _machine_for_engine() -> llvm.TargetMachine:
    # an engine takes ownership of its target machine, so each needs a new one
    _machine()
    return llvm.Target.from_default_triple().create_target_machine(opt=2)
