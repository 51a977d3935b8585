"""The number of threads that NumPy's linear algebra uses: one.

The matrices of a diagnosis are small. A second thread shortens none of their products, and after each of them it waits
for the next by spinning: with two threads the tests of the diagnosis take twice the processor time, and longer.
"""

import os

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Variables of the environment that NumPy reads when it is imported."""


def use_one_thread() -> None:
    """Let this process and those that it starts use one thread, unless the environment names a number.

    Called before NumPy is imported.
    """
    for name, value in ONE_THREAD.items():
        os.environ.setdefault(name, value)
