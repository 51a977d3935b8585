"""Settings of Python and NumPy for a process: one thread for linear algebra, and rare garbage collections.

The matrices of a diagnosis are small. A second thread shortens none of their products, and after each of them it waits
for the next by spinning: with two threads the tests of the diagnosis take twice the processor time, and longer.

Imports and derivations create objects that stay. By default Python searches for garbage whenever 700 more have been
created, which is a seventh of the time in which a service starts, and a tenth of that of a short run.
"""

import gc
import os

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "POLARS_MAX_THREADS": "1"}
"""Variables of the environment that NumPy and polars read when they are imported."""
BY_DEFAULT = gc.get_threshold()


def use_one_thread() -> None:
    """Let this process and those that it starts use one thread, unless the environment names a number.

    Called before NumPy and polars are imported.
    """
    for name, value in ONE_THREAD.items():
        os.environ.setdefault(name, value)


def collect_rarely() -> None:
    """Search the newest objects for garbage when 50 000 more have been created."""
    gc.set_threshold(50_000, 20, 20)


def collect_as_usual() -> None:
    """Search as often as Python does by default, and never what exists already, so that no collection takes long."""
    gc.freeze()
    gc.set_threshold(*BY_DEFAULT)
